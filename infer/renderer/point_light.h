// Light at surface points by gather rays and shadow rays.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/gi/radiosity_table.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// What is gathered from.
struct GatherScene {
  const pathtrace::Bvh& bvh;
  const pathtrace::Lights& lights;
  const gi::RadiosityTable& table;
  int max_depth = 5;  ///< of the picture: surface hits after the primary one
  uint64_t seed = 0;
};

/// Points of pixels, whose rays meet the same nodes and triangles if the pixels are neighbours.
struct LitPoints {
  std::vector<Vec3> position, normal;
  std::vector<size_t> pixel;

  size_t size() const { return position.size(); }
  void reserve(size_t count);
  LitPoints some(std::span<const size_t> which) const;
};

/// Rays a point; 0 where that light is not wanted.
struct LightRays {
  int gather = 0, shadow = 0;
};

/// Irradiance, an entry a point; empty where it is not wanted.
struct PointLight {
  std::vector<Rgb> direct, indirect;
};

/// What was done, summed over calls.
struct LightWork {
  int64_t points = 0;  ///< that had rays
  double gather_seconds = 0, direct_seconds = 0;
};

/// Estimates light at points.
/// @param first_index  numbers the streams of their rays
PointLight light_points(const GatherScene& scene, const LitPoints& points, const LightRays& rays,
                        int64_t first_index, LightWork* work);

}  // namespace lte::infer
