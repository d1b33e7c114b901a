// Internal: points of a SurfaceIndex side by side, so that a place weighs several at once.
#pragma once

#include <cstdint>

#include "lte/base/math.h"

namespace lte::gi {

/// Eight points of one list. Lanes without a point have a normal of 0, which weighs nothing.
struct alignas(64) SurfaceLanes {
  static constexpr int kLanes = 8;

  float x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
  float normal_x[kLanes] = {}, normal_y[kLanes] = {}, normal_z[kLanes] = {};
  float inverse_radius2[kLanes] = {};
  uint32_t point[kLanes] = {};  ///< its number in the index

  Vec3 position(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// The weights of SurfaceIndex::for_each(), 0 for points that do not speak for the place.
/// @param weights  [count * kLanes]
void weigh_lanes(const SurfaceLanes* lanes, int count, const Vec3& position, const Vec3& normal,
                 float* weights);

}  // namespace lte::gi
