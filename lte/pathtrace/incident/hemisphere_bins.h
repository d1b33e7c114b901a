// A hemisphere of directions cut into bins × bins cells of equal projected solid angle, π / bins²
// each: incident radiance is stored by them (the paper's section 5.3).
//
// The unit square is mapped to the disk by Shirley and Chiu's concentric map (A Low Distortion Map
// Between Disk and Square, 1997), and the disk up onto the hemisphere. Points that are uniform on
// the square become cosine-distributed directions; cells stay compact, and neighbours stay
// neighbours. Directions here are unit vectors with the normal as z axis.
#pragma once

#include "lte/base/math.h"

namespace lte::pathtrace {

/// The x axis of the frame; its y axis is cross(normal, tangent).
inline Vec3 bin_tangent(const Vec3& normal) {
  Vec3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  return tangent;
}

/// @param place  in [0, 1]²; cell (row, column) is [row, row + 1] × [column, column + 1] / bins, y
///               before x
Vec3 bin_direction(const Vec2& place);

/// The inverse of bin_direction(). @param direction  unit, z >= 0
Vec2 bin_place(const Vec3& direction);

/// Solid angle of a cell, sr; the cells of one grid sum to 2π. The mean density of
/// cosine-distributed directions in the cell is 1 / (bins² · this).
/// @param bins  even
double bin_solid_angle(int bins, int row, int column);

}  // namespace lte::pathtrace
