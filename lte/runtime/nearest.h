// The nearest of a set of points, found by the operator that the network is made of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::runtime {

/// Of each query the index of the nearest point, of several the first.
/// @throws lte::Error if there are no points, or a value is not finite
std::vector<int64_t> nearest_points(std::span<const Vec3> queries, std::span<const Vec3> points);

}  // namespace lte::runtime
