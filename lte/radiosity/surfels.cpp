#include "lte/radiosity/surfels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "lte/radiosity/constants.h"

namespace lte::radiosity {
namespace {

std::pair<int32_t, int32_t> key(const Surfel& s) { return {s.cell, s.axis}; }
bool comes_first(const Surfel& a, const Surfel& b) { return key(a) < key(b); }

/// Brings surfels into order and makes one of those of the same cell and axis: their means.
void merge(std::vector<Surfel>* surfels) {
  std::stable_sort(surfels->begin(), surfels->end(), comes_first);
  size_t kept = 0;
  for (size_t first = 0; first < surfels->size();) {
    Surfel mean = (*surfels)[first];
    size_t last = first + 1;
    for (; last < surfels->size() && key((*surfels)[last]) == key(mean); ++last) {
      mean.middle += (*surfels)[last].middle;
      mean.normal += (*surfels)[last].normal;
    }
    mean.middle = mean.middle / static_cast<float>(last - first);
    mean.normal = normalize(mean.normal);
    (*surfels)[kept++] = mean;
    first = last;
  }
  surfels->resize(kept);
}

/// Offsets in cells up to kReach long, of each two opposite ones that which comes first.
std::vector<std::array<int32_t, 3>> half_of_offsets() {
  std::vector<std::array<int32_t, 3>> offsets;
  for (int32_t x = 0; x <= kReach; ++x) {
    for (int32_t y = -kReach; y <= kReach; ++y) {
      for (int32_t z = -kReach; z <= kReach; ++z) {
        if (x * x + y * y + z * z > kReach * kReach) continue;
        if (std::array{x, y, z} > std::array{0, 0, 0}) offsets.push_back({x, y, z});
      }
    }
  }
  return offsets;
}

bool in_one_plane(const Surfel& a, const Surfel& b, float cell) {
  const Vec3 d = b.middle - a.middle;
  const float off = std::max(std::abs(dot(d, a.normal)), std::abs(dot(d, b.normal)));
  return a.axis == b.axis && off <= kFlat * cell && dot(a.normal, b.normal) >= kMinNormalCosine;
}

std::vector<Surfel> at_points(std::span<const Vec3> positions, std::span<const Vec3> normals,
                              const GridShape& grid) {
  std::vector<Surfel> surfels;
  surfels.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    Vec3 n = normals[i];
    const Vec3 size = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const int32_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (n[axis] < 0) n = -n;
    surfels.push_back({positions[i], n, grid.cell_at(grid.place(positions[i])), axis});
  }
  merge(&surfels);
  return surfels;
}

/// Finds the surfels of a cell.
class CellIndex {
 public:
  CellIndex(const std::vector<Surfel>& surfels, const GridShape& grid)
      : surfels_(surfels), ranges_(static_cast<size_t>(grid.cells())) {
    for (size_t i = 0; i < surfels.size(); ++i) {
      Range& range = ranges_[static_cast<size_t>(surfels[i].cell)];
      if (range.count++ == 0) range.first = static_cast<uint32_t>(i);
    }
  }

  std::span<const Surfel> in(int32_t cell) const {
    const Range& range = ranges_[static_cast<size_t>(cell)];
    return {surfels_.data() + range.first, range.count};
  }
  bool has(int32_t cell, int32_t axis) const {
    return std::ranges::any_of(in(cell), [&](const Surfel& s) { return s.axis == axis; });
  }

 private:
  struct Range {
    uint32_t first = 0, count = 0;
  };
  const std::vector<Surfel>& surfels_;
  std::vector<Range> ranges_;
};

/// Adds those on the line between two that lie in one plane, where there are none.
void close_line(const Surfel& from, const Surfel& to, int32_t cells, const GridShape& grid,
                const CellIndex& index, std::vector<Surfel>* fills) {
  const int32_t steps = 2 * cells;
  const Vec3 step = (to.middle - from.middle) / static_cast<float>(steps);
  for (int32_t i = 1; i < steps; ++i) {
    const Vec3 p = from.middle + step * static_cast<float>(i);
    const int32_t cell = grid.cell_at(grid.place(p));
    if (!index.has(cell, from.axis)) fills->push_back({p, from.normal, cell, from.axis});
  }
}

/// Those between two near ones of one plane.
std::vector<Surfel> between(const std::vector<Surfel>& surfels, const GridShape& grid) {
  const CellIndex index(surfels, grid);
  const std::vector<std::array<int32_t, 3>> offsets = half_of_offsets();
  const std::array<int64_t, 3> strides = grid.strides();
  std::vector<Surfel> fills;
  for (const Surfel& s : surfels) {
    const std::array<int64_t, 3> at = {s.cell / strides[0], s.cell % strides[0] / strides[1],
                                       s.cell % strides[1]};
    for (const std::array<int32_t, 3>& offset : offsets) {
      bool inside = true;
      int64_t there = s.cell;
      for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t to = at[axis] + offset[axis];
        inside &= to >= 0 && to < grid.size[axis];
        there += offset[axis] * strides[axis];
      }
      if (!inside) continue;
      const int32_t cells = std::max({offset[0], std::abs(offset[1]), std::abs(offset[2])});
      for (const Surfel& other : index.in(static_cast<int32_t>(there))) {
        if (in_one_plane(s, other, grid.cell)) close_line(s, other, cells, grid, index, &fills);
      }
    }
  }
  merge(&fills);
  return fills;
}

}  // namespace

std::vector<Surfel> surfels_of(std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const GridShape& grid) {
  std::vector<Surfel> surfels = at_points(positions, normals, grid);
  const std::vector<Surfel> fills = between(surfels, grid);
  const auto points = static_cast<std::ptrdiff_t>(surfels.size());
  surfels.insert(surfels.end(), fills.begin(), fills.end());
  std::inplace_merge(surfels.begin(), surfels.begin() + points, surfels.end(), comes_first);
  return surfels;
}

}  // namespace lte::radiosity
