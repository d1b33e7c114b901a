// A hemisphere of directions cut into bins × bins cells of equal projected solid angle, π / bins²
// each: incident radiance is stored by them (the paper's section 5.3).
//
// The unit square is mapped to the disk by Shirley and Chiu's concentric map (A Low Distortion Map
// Between Disk and Square, 1997), and the disk up onto the hemisphere. Points that are uniform on
// the square become cosine-distributed directions; cells stay compact, and neighbours stay
// neighbours. Directions here are unit vectors with the normal as z axis.
#pragma once

#include <vector>

#include "lte/base/math.h"

namespace lte::pathtrace {

/// The x axis of the frame; its y axis is cross(normal, tangent).
inline Vec3 bin_tangent(const Vec3& normal) {
  Vec3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  return tangent;
}

/// The frame around a unit normal, in world space.
class BinFrame {
 public:
  explicit BinFrame(const Vec3& normal)
      : normal_(normal), tangent_(bin_tangent(normal)), bitangent_(cross(normal, tangent_)) {}
  const Vec3& normal() const { return normal_; }
  Vec3 to_world(const Vec3& v) const { return tangent_ * v.x + bitangent_ * v.y + normal_ * v.z; }
  Vec3 to_local(const Vec3& v) const {
    return {dot(v, tangent_), dot(v, bitangent_), dot(v, normal_)};
  }

 private:
  Vec3 normal_, tangent_, bitangent_;
};

/// @param place  in [0, 1]²; cell (row, column) is [row, row + 1] × [column, column + 1] / bins, y
///               before x
Vec3 bin_direction(const Vec2& place);

/// The inverse of bin_direction(). @param direction  unit, z >= 0
Vec2 bin_place(const Vec3& direction);

/// The direction in the middle of a cell, which stands for it.
Vec3 bin_centre(int bins, int row, int column);

/// Those of all cells around a normal, row by row, in world space.
std::vector<Vec3> bin_centres(int bins, const Vec3& normal);

/// Solid angle of a cell, sr; the cells of one grid sum to 2π. The mean density of
/// cosine-distributed directions in the cell is 1 / (bins² · this).
/// @param bins  even
double bin_solid_angle(int bins, int row, int column);

}  // namespace lte::pathtrace
