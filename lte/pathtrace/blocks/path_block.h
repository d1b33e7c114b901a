// Internal: paths side by side. Many paths of one query point, or of pixels of one row, advance
// together, a stage at a time (sample, intersect, shade, shadow), so that Embree gets packets and
// the arithmetic between its calls runs on several paths at once (Laine et al., Megakernels
// Considered Harmful, HPG 2013). A lane is a place in the block; paths that end are closed up.
#pragma once

#include <cstdint>

#include "lte/base/math.h"

namespace lte::pathtrace {

/// Paths that advance together: enough to fill packets after most have ended, few enough for the
/// cache.
inline constexpr int kBlock = 256;

/// A vector a lane.
struct Lanes3 {
  alignas(64) float x[kBlock], y[kBlock], z[kBlock];

  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void put(int lane, const Vec3& v) {
    x[lane] = v.x;
    y[lane] = v.y;
    z[lane] = v.z;
  }
};

/// Where paths stand before their next rays.
struct PathBlock {
  int size = 0;              ///< lanes in use
  Lanes3 origin, direction;  ///< relative to the frame origin; directions are unit
  Lanes3 normal;             ///< at the origin, of the side that the path left; zero for a camera
  Lanes3 throughput;
  /// Solid-angle density of `direction`; 0 if no light sample competes with it (a camera ray).
  alignas(64) float pdf[kBlock];
  /// What the sampler and the sink know the path by: its lane when the block was started.
  alignas(64) int32_t path[kBlock];
};

/// What rays met.
struct HitBlock {
  alignas(64) int32_t instance[kBlock];  ///< scene::kNone for a miss
  alignas(64) uint32_t triangle[kBlock];
  alignas(64) float t[kBlock], u[kBlock], v[kBlock];
  Lanes3 normal;  ///< Embree's: not unit, in the instance's own frame
};

/// Shadow rays and what they bring if nothing is in their way.
struct ShadowBlock {
  int size = 0;
  Lanes3 origin, direction, value;
  alignas(64) float t_max[kBlock];
  alignas(64) int32_t light_group[kBlock], path[kBlock];
};

/// One sample of light for each lane (LightSample, light_sample.h).
struct LightBlock {
  Lanes3 direction, radiance;
  alignas(64) float distance[kBlock];
  /// As LightSample::pdf, 0 where nothing arrives; negated for delta lights.
  alignas(64) float pdf[kBlock];
  alignas(64) int32_t light_group[kBlock];
};

}  // namespace lte::pathtrace
