// Internal: the unit square onto a triangle.
#pragma once

#include <algorithm>

#include "lte/base/math.h"

namespace lte::pathtrace {

/// Heitz's low-distortion map of the unit square onto barycentrics (2019), without a branch that
/// half of all samples would mispredict.
inline Vec3 square_to_triangle(const Vec2& u) {
  const float x = u.x * 0.5f, y = u.y * 0.5f, offset = y - x;
  const float b1 = x - std::min(offset, 0.0f), b2 = y + std::max(offset, 0.0f);
  return {1 - b1 - b2, b1, b2};
}

}  // namespace lte::pathtrace
