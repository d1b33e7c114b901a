// Points of a surface in a regular grid: enough to tell, without the surface, whether two points
// see each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/radiosity/grid_shape.h"
#include "lte/radiosity/marches.h"

namespace lte::radiosity {

class OccupancyGrid {
 public:
  /// Cells are cubes of side `cell` metres, or larger ones where too many would be needed.
  /// @param normals  unit vectors, either way around, one a position
  OccupancyGrid(std::span<const Vec3> positions, std::span<const Vec3> normals, float cell);

  const GridShape& shape() const { return grid_.shape; }
  const MarkedGrid& marked() const { return grid_; }

  /// Whether no surface lies between `a` and each of `others`, one entry each. One that an end lies
  /// on is not between. Space outside the grid is empty.
  void see(const Vec3& a, std::span<const Vec3> others, std::vector<uint8_t>* visible) const;

 private:
  void measure_clearance();

  MarkedGrid grid_;
};

}  // namespace lte::radiosity
