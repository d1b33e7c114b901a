// A regular grid of cubes around points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "lte/base/math.h"

namespace lte::radiosity {

struct GridShape {
  float cell = 0, inverse = 0;  ///< side in metres, and one over it
  Vec3 low;                     ///< corner
  std::array<int32_t, 3> size{};

  /// Of cells of side `cell` metres, or of a larger one where more than 2²⁴ would be needed; at
  /// least one free cell is on either side of the points. Without points it has no cells.
  static GridShape around(std::span<const Vec3> positions, float cell);

  int64_t cells() const { return int64_t{size[0]} * size[1] * size[2]; }
  std::array<int64_t, 3> strides() const { return {int64_t{size[1]} * size[2], size[2], 1}; }
  /// In cells from the corner.
  Vec3 place(const Vec3& p) const { return (p - low) * inverse; }
  /// Index of the cell at a place; the nearest one to a place outside.
  int32_t cell_at(const Vec3& place) const;
  /// Index of the cell that `p` lies in; none outside the grid.
  std::optional<int32_t> cell_of(const Vec3& p) const;
};

}  // namespace lte::radiosity
