// Points of a surface in a regular grid: enough to tell, without the surface, whether two points
// see each other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/radiosity/grid_shape.h"
#include "lte/radiosity/surfels.h"

namespace lte::radiosity {

class OccupancyGrid {
 public:
  /// Cells are cubes of side `cell` metres, or larger ones where too many would be needed.
  /// @param normals  unit vectors, either way around, one a position
  OccupancyGrid(std::span<const Vec3> positions, std::span<const Vec3> normals, float cell);

  const GridShape& shape() const { return shape_; }

  /// Whether no surface lies between `a` and each of `others`, one entry each. One that an end lies
  /// on is not between. Space outside the grid is empty.
  void see(const Vec3& a, std::span<const Vec3> others, std::vector<uint8_t>* visible) const;

 private:
  struct Marches;

  void measure_clearance();
  void start(const Vec3& from, const Vec3& to, size_t lane, Marches* marches) const;
  bool leap(Marches* marches) const;
  bool blocks(int32_t mark, const Vec3& a, const Vec3& b) const;

  GridShape shape_;
  std::vector<Surfel> surfels_;
  /// Of an empty cell: cells to the nearest that is not, along the axis on which that is farthest.
  /// Marches leap over what is empty. Of one with surfels: where they are, below 0 (mark_of()), as
  /// a march that has looked up one number hardly waits for another.
  std::vector<int32_t> clearance_;
};

}  // namespace lte::radiosity
