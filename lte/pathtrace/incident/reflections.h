// Where the light comes from that pixels see reflected: surface points, and directions drawn as
// likely as the surface reflects light from them. For renderers that know the radiance which
// arrives (a radiance decoder) and trace no path on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

struct ReflectionOptions {
  int points = 4;      ///< places in a pixel
  int directions = 4;  ///< of each surface point that they meet
  uint64_t seed = 0;
};

/// The radiance that a pixel reflects is Σ weight · L(direction) over its points' directions,
/// divided by `points` · `directions`: places that meet nothing count as samples of 0.
struct Reflections {
  std::vector<int32_t> pixel;          ///< [points] its place among the pixels
  std::vector<Vec3> position, normal;  ///< [points] the normal is of the visible side
  std::vector<Rgb> albedo;             ///< [points]
  /// [points, directions] unit, away from the surface, and f cosθ / pdf; the normal and 0 for a
  /// draw that no direction came of.
  std::vector<Vec3> direction;
  std::vector<Rgb> weight;
};

/// Visible normals of GGX and the cosine, by the share of metal. A pixel's draws depend on the seed
/// and on its number alone.
/// @param pixels  y * width + x
/// @throws lte::Error if a size or an option is not positive or the camera is degenerate.
Reflections draw_reflections(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                             std::span<const int64_t> pixels, const ReflectionOptions& options);

}  // namespace lte::pathtrace
