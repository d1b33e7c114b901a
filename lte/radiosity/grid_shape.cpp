#include "lte/radiosity/grid_shape.h"

#include <algorithm>

#include "lte/radiosity/constants.h"

namespace lte::radiosity {

GridShape GridShape::around(std::span<const Vec3> positions, float cell) {
  GridShape grid;
  grid.cell = cell;
  Bounds bounds;
  for (const Vec3& p : positions) bounds.extend(p);
  if (bounds.empty()) return grid;
  const Vec3 extent = bounds.extent();
  // One on either side, and one for points on the far faces of the bounds: marches leave the
  // outermost marked cells before they leave the grid.
  const auto count = [&](int axis) {
    return 3 + static_cast<int64_t>(static_cast<double>(extent[axis]) / grid.cell);
  };
  grid.cell = std::max(grid.cell, kMinCell * max_component(extent));
  if (grid.cell <= 0) grid.cell = 1;  // all points in one place
  while (count(0) * count(1) * count(2) > kMaxCells) grid.cell *= kCellGrowth;
  grid.inverse = 1 / grid.cell;
  grid.low = bounds.low - Vec3{grid.cell, grid.cell, grid.cell};
  for (int axis = 0; axis < 3; ++axis)
    grid.size[static_cast<size_t>(axis)] = static_cast<int32_t>(count(axis));
  return grid;
}

int32_t GridShape::cell_at(const Vec3& place) const {
  const auto on = [&](float value, size_t axis) {
    return std::clamp(static_cast<int32_t>(value), 0, size[axis] - 1);
  };
  return (on(place.x, 0) * size[1] + on(place.y, 1)) * size[2] + on(place.z, 2);
}

std::optional<int32_t> GridShape::cell_of(const Vec3& p) const {
  const Vec3 at = place(p);
  for (int axis = 0; axis < 3; ++axis) {
    const auto cells = static_cast<float>(size[static_cast<size_t>(axis)]);
    if (!(at[axis] >= 0 && at[axis] < cells)) return std::nullopt;
  }
  return cell_at(at);
}

}  // namespace lte::radiosity
