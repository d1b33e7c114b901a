// Texels on all surfaces of a scene, in charts on one picture: where a light map keeps its light.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/image/image.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Triangles of an instance that touch each other and look the same way (along the axis that their
/// normals are nearest to) make a chart, which is flattened along that axis. Charts stand apart by
/// two texels.
struct TexelAtlas {
  int width = 0, height = 0;
  float edge = 0;  ///< of a texel, metres
  // One entry a texel on a surface, or next to one in its chart, row by row.
  std::vector<uint32_t> place;         ///< y * width + x
  std::vector<Vec3> position, normal;  ///< world; the front side's

  int64_t size() const { return static_cast<int64_t>(place.size()); }
  /// A picture of values at texels, 0 elsewhere.
  image::Image picture(const std::vector<Vec3>& values) const;
};

/// @param count  texels, about: their edge is that of the square of an even share of the surface
/// @throws lte::Error for a scene without surface, or too large for its texels.
TexelAtlas make_texel_atlas(const scene::Scene& scene, int64_t count);

}  // namespace lte::infer
