// The light of a light map at the vertices of its scene, whose triangles are cut where light bends.
//
// A vertex has the value with which linear interpolation over the triangles around it is nearest to
// the light inside them (Kavan et al., "Least squares vertex baking", 2011): what lies beyond an
// edge does not count. Triangles that meet smoothly share vertices; where they do not, each side
// has its own.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/bake/lightmap.h"

namespace lte::bake {

struct VertexOptions {
  /// Triangles are halved until light is nowhere off linear interpolation by more than this share
  /// of the light there (at least a tenth of the mean light), or they have the size of texels.
  double bend = 0.1;
  int64_t max_triangles = 1'000'000;  ///< of all instances; those of the scene at least
};

struct VertexLight {
  scene::Scene scene;                        ///< instance i has mesh i; no uvs[1]
  std::vector<std::vector<Rgb>> irradiance;  ///< [meshes][vertices] E, W/m², all layers
  int64_t triangles_before = 0, triangles = 0;
  double off_p95 = 0;    ///< as `bend`: what 95 % of the surface is below, noise included
  bool limited = false;  ///< max_triangles left some halves out
};

VertexLight vertex_light(const Lightmap& map, const VertexOptions& options);

}  // namespace lte::bake
