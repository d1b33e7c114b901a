// Where rays from a surface start, shadow rays too, so that they do not meet that surface.
#pragma once

#include "lte/base/math.h"

namespace lte::pathtrace {

/// A point moved off its surface along `side` (unit, towards the hemisphere the ray leaves into),
/// so that a ray from it does not meet its own triangle: by 2^-20 of its largest coordinate or of
/// `magnitude`, several times the rounding of a point sampled on triangles of such coordinates.
/// @param magnitude  e.g. half the extent of the scene: a point near the origin of a large triangle
///                   is no more exact than the triangle's corners
Vec3 offset_origin(const Vec3& position, const Vec3& side, float magnitude = 0);

}  // namespace lte::pathtrace
