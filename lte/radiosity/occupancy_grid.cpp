#include "lte/radiosity/occupancy_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lte/base/vector_clones.h"

namespace lte::radiosity {
namespace {

/// Steps of a march, in cells: short enough that few marked cells are stepped over.
constexpr float kStep = 0.7f;
/// Clearances are told up to this many cells.
constexpr int32_t kFarthest = 16;
/// Cells by which an end may lie off a surfel's plane and still be on that surface.
constexpr float kOwnCells = 0.4f;
/// Cells around its middle in which a surfel blocks.
constexpr float kRadiusCells = 1;
/// Marches that go on side by side: several vectors of them, as each waits for its cells.
constexpr size_t kLanes = 64;
/// Of those whose hits are told in one word of 32 bits, which vectors hold.
constexpr size_t kWord = 16;

/// What stands for the surfels of a cell, at most one an axis, in place of its clearance.
int32_t mark_of(size_t first, size_t count) { return -static_cast<int32_t>(4 * first + count); }
std::span<const Surfel> marked(const std::vector<Surfel>& surfels, int32_t mark) {
  return {surfels.data() + (-mark >> 2), static_cast<size_t>(-mark & 3)};
}

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

/// Segments of one block, in cells from the grid's corner, each at `at` of its length.
struct OccupancyGrid::Marches {
  std::array<float, kLanes> x, y, z, dx, dy, dz, at, end;
  std::array<int32_t, kLanes> clearance;
  uint64_t hits;  ///< bit i: lane i has come to a marked cell
};
static_assert(kLanes == 64 && kLanes % kWord == 0, "Marches::hits has a bit a lane");

OccupancyGrid::OccupancyGrid(std::span<const Vec3> positions, std::span<const Vec3> normals,
                             float cell)
    : shape_(GridShape::around(positions, cell)),
      surfels_(surfels_of(positions, normals, shape_)),
      clearance_(static_cast<size_t>(shape_.cells()), kFarthest) {
  for (const Surfel& surfel : surfels_) clearance_[static_cast<size_t>(surfel.cell)] = 0;
  measure_clearance();
  for (size_t first = 0, last = 0; first < surfels_.size(); first = last) {
    while (last < surfels_.size() && surfels_[last].cell == surfels_[first].cell) ++last;
    clearance_[static_cast<size_t>(surfels_[first].cell)] = mark_of(first, last - first);
  }
}

/// One axis after another: a distance in the maximum norm is the largest of those along the axes.
void OccupancyGrid::measure_clearance() {
  const std::array<int64_t, 3> stride = shape_.strides();
  std::vector<int32_t> line, out;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t length = shape_.size[axis], step = stride[axis];
    line.resize(static_cast<size_t>(length));
    out.resize(line.size());
    const size_t other = axis == 0 ? 1 : 0, third = axis == 2 ? 1 : 2;
    for (int64_t i = 0; i < shape_.size[other]; ++i) {
      for (int64_t j = 0; j < shape_.size[third]; ++j) {
        int32_t* first = clearance_.data() + i * stride[other] + j * stride[third];
        for (int64_t k = 0; k < length; ++k) line[static_cast<size_t>(k)] = first[k * step];
        spread(line, &out);
        for (int64_t k = 0; k < length; ++k) first[k * step] = out[static_cast<size_t>(k)];
      }
    }
  }
}

/// Sets the march of a lane to the part of the segment that lies in the grid.
void OccupancyGrid::start(const Vec3& from, const Vec3& to, size_t lane, Marches* marches) const {
  const Vec3 a = shape_.place(from), whole = shape_.place(to) - a;
  const float distance = length(whole);
  const Vec3 u = normalize(whole);
  float near = 0, far = distance;
  for (int axis = 0; axis < 3; ++axis) {
    const auto high = static_cast<float>(shape_.size[static_cast<size_t>(axis)]);
    if (u[axis] == 0) {
      if (a[axis] < 0 || a[axis] > high) far = -1;
      continue;
    }
    const float first = -a[axis] / u[axis], last = (high - a[axis]) / u[axis];
    near = std::max(near, std::min(first, last));
    far = std::min(far, std::max(first, last));
  }
  marches->x[lane] = a.x;
  marches->y[lane] = a.y;
  marches->z[lane] = a.z;
  marches->dx[lane] = u.x;
  marches->dy[lane] = u.y;
  marches->dz[lane] = u.z;
  marches->at[lane] = near;
  marches->end[lane] = far;
}

/// Looks up the cells of all marches, notes hits and moves each past what is empty. False when all
/// have ended; one that has ended hits nothing.
LTE_VECTOR_CLONES
bool OccupancyGrid::leap(Marches* marches) const {
  const std::array<int32_t, 3>& size = shape_.size;
  const int32_t nx = size[0] - 1, ny = size[1] - 1, nz = size[2] - 1;
  const int32_t step_x = size[1] * size[2], step_y = size[2];
  // Pointers, as the compiler keeps no loop over std::array in vectors.
  const int32_t* __restrict clearances = clearance_.data();
  const float *ox = marches->x.data(), *oy = marches->y.data(), *oz = marches->z.data(),
              *dx = marches->dx.data(), *dy = marches->dy.data(), *dz = marches->dz.data(),
              *end = marches->end.data();
  float* __restrict at = marches->at.data();
  int32_t* __restrict clearance = marches->clearance.data();
  int32_t cell[kLanes];
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const auto x = static_cast<int32_t>(ox[lane] + dx[lane] * at[lane]);
    const auto y = static_cast<int32_t>(oy[lane] + dy[lane] * at[lane]);
    const auto z = static_cast<int32_t>(oz[lane] + dz[lane] * at[lane]);
    const int32_t cx = std::min(std::max(x, 0), nx);
    const int32_t cy = std::min(std::max(y, 0), ny);
    const int32_t cz = std::min(std::max(z, 0), nz);
    cell[lane] = cx * step_x + cy * step_y + cz;
  }
  // By itself: the compiler gathers nothing, and would leave the rest of the loop scalar as well.
  for (size_t lane = 0; lane < kLanes; ++lane)
    clearance[lane] = clearances[static_cast<size_t>(cell[lane])];
  int32_t live = 0;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const int32_t on = at[lane] <= end[lane] ? 1 : 0;
    at[lane] += std::max(static_cast<float>(clearance[lane] - 1), kStep);
    clearance[lane] = on != 0 ? clearance[lane] : kFarthest;
    live |= on;
  }
  marches->hits = 0;
  for (size_t first = 0; first < kLanes; first += kWord) {
    uint32_t word = 0;
    for (size_t lane = 0; lane < kWord; ++lane)
      word |= (clearance[first + lane] < 0 ? 1u : 0u) << lane;
    marches->hits |= uint64_t{word} << first;
  }
  return live != 0;
}

/// Whether the segment crosses a surfel of a cell, or the part of its plane right beside it.
bool OccupancyGrid::blocks(int32_t mark, const Vec3& a, const Vec3& b) const {
  const float own = kOwnCells * shape_.cell, radius = kRadiusCells * shape_.cell;
  bool blocked = false;
  for (const Surfel& s : marked(surfels_, mark)) {
    const float above = dot(a - s.middle, s.normal), below = dot(b - s.middle, s.normal);
    // From the middle to where the plane is crossed, times `span`: as in see(), nothing is branched
    // on, and nothing divided by.
    const float span = above - below, reach = radius * span;
    const Vec3 off = (a - s.middle) * span + (b - a) * above;
    blocked |= (above * below < 0) & (std::min(std::abs(above), std::abs(below)) > own) &
               (dot(off, off) < reach * reach);
  }
  return blocked;
}

void OccupancyGrid::see(const Vec3& a, std::span<const Vec3> others,
                        std::vector<uint8_t>* visible) const {
  visible->assign(others.size(), 1);
  if (clearance_.empty()) return;
  Marches marches;
  for (size_t first = 0; first < others.size(); first += kLanes) {
    const size_t count = std::min(kLanes, others.size() - first);
    for (size_t lane = 0; lane < kLanes; ++lane) {
      start(a, others[first + std::min(lane, count - 1)], lane, &marches);
      if (lane >= count) marches.end[lane] = -1;
    }
    while (leap(&marches)) {
      for (uint64_t hits = marches.hits; hits != 0; hits &= hits - 1) {
        const auto lane = static_cast<size_t>(std::countr_zero(hits));
        // Selected, not branched on: nobody foretells which hits block.
        const bool blocked = blocks(marches.clearance[lane], a, others[first + lane]);
        uint8_t& seen = (*visible)[first + lane];
        seen = blocked ? 0 : seen;
        marches.end[lane] = blocked ? -1 : marches.end[lane];
      }
    }
  }
}

}  // namespace lte::radiosity
