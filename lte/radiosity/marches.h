// Segments from one point through a grid of surfels, many side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/radiosity/grid_shape.h"
#include "lte/radiosity/surfels.h"

namespace lte::radiosity {

/// Surfels in the order of their cells, and a number a cell: of an empty one, cells to the nearest
/// that is not, along the axis on which that is farthest; of another mark_of() its surfels, below
/// 0. A march that has looked up one number hardly waits for another.
struct MarkedGrid {
  GridShape shape;
  std::vector<Surfel> surfels;
  std::vector<int32_t> clearance;

  /// Stands for the surfels of a cell, at most one an axis.
  static int32_t mark_of(size_t first, size_t count) {
    return -static_cast<int32_t>(4 * first + count);
  }
  std::span<const Surfel> marked(int32_t mark) const {
    return {surfels.data() + (-mark >> 2), static_cast<size_t>(-mark & 3)};
  }
};

/// OccupancyGrid::see(); the grid has cells.
/// @param visible  an entry for each of `others`
void march(const MarkedGrid& grid, const Vec3& a, std::span<const Vec3> others,
           std::span<uint8_t> visible);

}  // namespace lte::radiosity
