// Triangulation of polygons.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::scene {

/// Splits a polygon in space into triangles of its own winding, appended to `out`: a fan where it
/// is convex, else by ear clipping in its plane. There are always corners − 2 triangles, whatever
/// the polygon.
/// @param corners  3 or more, indices into `positions`
/// @note Outlines that cross themselves lose some of their shape, and those of many thousand
/// corners end in a fan when clipping has taken its time.
void triangulate_polygon(const std::vector<Vec3>& positions, const std::vector<uint32_t>& corners,
                         std::vector<std::array<uint32_t, 3>>* out);

}  // namespace lte::scene
