// A light map of a scene: atlas, texels, light, and the picture of it.
#pragma once

#include <memory>

#include "lte/bake/finish.h"
#include "lte/bake/lightmap.h"

namespace lte::bake {

/// The layout of a bake, which all of its layers share.
struct Layout {
  Atlas atlas;
  Texels texels;
};
Layout make_layout(const scene::Scene& scene, const AtlasOptions& options);

/// Light groups are layers of their own where `name` says which; "light" for all in one.
struct BakedLayer {
  std::string name;
  TexelLight light;
};

/// Puts layers of one layout into a light map. A texel is dark where all layers are. Where names of
/// layers are alike, all but the first get a number.
/// @param bvh       of the scene
/// @param seam_p99  gets the difference across joined seams that a hundredth exceeds, relative to
///                  the light there; may be null
/// @throws lte::Error without layers, or where layers chose different sides
Lightmap make_lightmap(const pathtrace::Bvh& bvh, Layout layout, std::vector<BakedLayer> layers,
                       Provenance provenance, double* seam_p99);

}  // namespace lte::bake
