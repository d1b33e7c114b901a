#include "lte/radiosity/occupancy_grid.h"

#include <algorithm>
#include <array>

#include "lte/radiosity/constants.h"

namespace lte::radiosity {
namespace {

/// out[i] = min over j of max(line[j], |i - j|), at most kFarthest.
void spread(const std::vector<int32_t>& line, std::vector<int32_t>* out) {
  const size_t n = line.size();
  for (size_t i = 0; i < n; ++i) {
    int32_t best = line[i];
    for (size_t away = 1; away < static_cast<size_t>(best); ++away) {
      const auto steps = static_cast<int32_t>(away);
      if (i >= away) best = std::min(best, std::max(line[i - away], steps));
      if (i + away < n) best = std::min(best, std::max(line[i + away], steps));
    }
    (*out)[i] = best;
  }
}

}  // namespace

OccupancyGrid::OccupancyGrid(std::span<const Vec3> positions, std::span<const Vec3> normals,
                             float cell) {
  grid_.shape = GridShape::around(positions, cell);
  grid_.surfels = surfels_of(positions, normals, grid_.shape);
  grid_.clearance.assign(static_cast<size_t>(grid_.shape.cells()), kFarthest);
  const std::vector<Surfel>& surfels = grid_.surfels;
  for (const Surfel& surfel : surfels) grid_.clearance[static_cast<size_t>(surfel.cell)] = 0;
  measure_clearance();
  for (size_t first = 0, last = 0; first < surfels.size(); first = last) {
    while (last < surfels.size() && surfels[last].cell == surfels[first].cell) ++last;
    grid_.clearance[static_cast<size_t>(surfels[first].cell)] =
        MarkedGrid::mark_of(first, last - first);
  }
}

/// One axis after another: a distance in the maximum norm is the largest of those along the axes.
void OccupancyGrid::measure_clearance() {
  const std::array<int64_t, 3> stride = grid_.shape.strides();
  std::vector<int32_t> line, out;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t length = grid_.shape.size[axis], step = stride[axis];
    line.resize(static_cast<size_t>(length));
    out.resize(line.size());
    const size_t other = axis == 0 ? 1 : 0, third = axis == 2 ? 1 : 2;
    for (int64_t i = 0; i < grid_.shape.size[other]; ++i) {
      for (int64_t j = 0; j < grid_.shape.size[third]; ++j) {
        int32_t* first = grid_.clearance.data() + i * stride[other] + j * stride[third];
        for (int64_t k = 0; k < length; ++k) line[static_cast<size_t>(k)] = first[k * step];
        spread(line, &out);
        for (int64_t k = 0; k < length; ++k) first[k * step] = out[static_cast<size_t>(k)];
      }
    }
  }
}

void OccupancyGrid::see(const Vec3& a, std::span<const Vec3> others,
                        std::vector<uint8_t>* visible) const {
  visible->assign(others.size(), 1);
  if (!grid_.clearance.empty()) march(grid_, a, others, *visible);
}

}  // namespace lte::radiosity
