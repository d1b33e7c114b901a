// Which cells of a regular grid hold points of a surface: enough to tell, without the surface,
// whether two points see each other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::radiosity {

class OccupancyGrid {
 public:
  /// Marks the cells that `positions` lie in. Cells are cubes of side `cell` metres, or of a larger
  /// one where more than kMostCells would be needed.
  OccupancyGrid(std::span<const Vec3> positions, float cell);

  float cell() const { return cell_; }
  /// Index of the cell that `p` lies in; none outside the grid.
  std::optional<int32_t> cell_of(const Vec3& p) const;

  /// A point of a surface.
  struct End {
    Vec3 position, normal;  ///< unit normal
  };
  /// Whether nothing marked lies between `a` and each of `others`, one entry each. Cells whose
  /// points lie in the tangent plane of either end belong to its own surface and do not count.
  /// Space outside the grid is empty.
  void see(const End& a, std::span<const End> others, std::vector<uint8_t>* visible) const;

 private:
  static constexpr int64_t kMostCells = int64_t{1} << 24;
  struct Marches;

  Vec3 place(const Vec3& p) const { return (p - low_) * inverse_; }
  int32_t cell_at(const Vec3& place) const;
  void measure_clearance();
  void start(const Vec3& from, const Vec3& to, size_t lane, Marches* marches) const;
  bool leap(Marches* marches) const;
  bool blocks(int32_t cell, const End& a, const End& b) const;

  float cell_ = 0, inverse_ = 0;
  Vec3 low_;
  std::array<int32_t, 3> size_{};
  /// Cells to the nearest marked one, along the axis on which that is farthest; 0 for a marked
  /// cell. Marches leap over what is empty.
  std::vector<int32_t> clearance_;
  std::vector<Vec3> middle_;  ///< of the points in each marked cell
};

}  // namespace lte::radiosity
