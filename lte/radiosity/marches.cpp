// A march leaps over what is empty and looks at the surfels of marked cells that it comes to. Some
// are over after three leaps and some after sixty, so that a lane which has come to its end goes on
// with the next segment.
#include "lte/radiosity/marches.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "lte/base/vector_clones.h"
#include "lte/radiosity/constants.h"

namespace lte::radiosity {
namespace {

/// Marches that go on side by side: several vectors of them, as each waits for its cells.
constexpr size_t kLanes = 64;
/// Lanes are worked off by so many, whose flags vectors bring into one word of 32 bits.
constexpr size_t kWord = 16;
static_assert(kLanes == 64 && kLanes % kWord == 0, "Leap has a bit a lane");
/// Segments that are made ready at once.
constexpr size_t kSegments = 512;
/// Surfels of as many cells as there are lanes.
constexpr size_t kMaxTests = 3 * kLanes;

/// Directions in cells, where along them marches are, and where these leave grid or segment.
template <size_t COUNT>
struct Rays {
  std::array<float, COUNT> dx, dy, dz, at, end;

  template <size_t OTHERS>
  void set(size_t to, const Rays<OTHERS>& from, size_t i) {
    dx[to] = from.dx[i];
    dy[to] = from.dy[i];
    dz[to] = from.dz[i];
    at[to] = from.at[i];
    end[to] = from.end[i];
  }
};

/// Segments from one point, marches at where they enter the grid, and their other ends in the
/// world.
struct Segments : Rays<kSegments> {
  std::array<float, kSegments> x, y, z;
};

struct Lanes : Rays<kLanes> {
  std::array<int32_t, kLanes> clearance;  ///< of the cell that it has come to
  std::array<int32_t, kLanes> tested;     ///< the mark that it came to last; 0: none
  std::array<size_t, kLanes> segment;
};

/// A bit a lane.
struct Leap {
  uint64_t hits;  ///< it has come to a marked cell, and not to the same again
  uint64_t over;  ///< it is past its end
};

/// Surfels that segments have come to, and the segments' ends.
struct Tests {
  std::array<float, kMaxTests> x, y, z, nx, ny, nz, to_x, to_y, to_z;
  std::array<size_t, kMaxTests> lane;
  std::array<int32_t, kMaxTests> blocked;
  size_t count;
};

/// Fills in what follows from the ends of `count` segments. Space outside the grid is empty.
/// @param a  where they begin, in cells
LTE_VECTOR_CLONES
void aim(const GridShape& shape, const Vec3& a, size_t count, Segments* segments) {
  // Pointers, as the compiler keeps no loop over std::array in vectors.
  const float *x = segments->x.data(), *y = segments->y.data(), *z = segments->z.data();
  float *__restrict dx = segments->dx.data(), *__restrict dy = segments->dy.data(),
                   *__restrict dz = segments->dz.data(), *__restrict at = segments->at.data(),
                   *__restrict end = segments->end.data();
  const Vec3 low = shape.low;
  const float inverse = shape.inverse;
  for (size_t i = 0; i < count; ++i) {
    const float wx = (x[i] - low.x) * inverse - a.x, wy = (y[i] - low.y) * inverse - a.y,
                wz = (z[i] - low.z) * inverse - a.z;
    const float distance = std::sqrt(wx * wx + wy * wy + wz * wz);
    dx[i] = distance > 0 ? wx / distance : wx;
    dy[i] = distance > 0 ? wy / distance : wy;
    dz[i] = distance > 0 ? wz / distance : wz;
    at[i] = 0;
    end[i] = distance;
  }
  const std::array<const float*, 3> direction = {dx, dy, dz};
  for (int axis = 0; axis < 3; ++axis) {
    const float* __restrict u = direction[static_cast<size_t>(axis)];
    const float from = a[axis], high = static_cast<float>(shape.size[static_cast<size_t>(axis)]);
    const bool outside = from < 0 || from > high;
    for (size_t i = 0; i < count; ++i) {
      const float first = -from / u[i], last = (high - from) / u[i];
      const float near = std::max(at[i], std::min(first, last));
      const float far = std::min(end[i], std::max(first, last));
      const bool along = u[i] == 0;
      at[i] = along ? at[i] : near;
      end[i] = along ? (outside ? -1 : end[i]) : far;
    }
  }
}

/// A bit for each of `count` flags, 0 or 1 each; `count` a multiple of kWord.
inline uint64_t bits_of(const int32_t* flags, size_t count) {
  uint64_t bits = 0;
  for (size_t first = 0; first < count; first += kWord) {
    uint32_t word = 0;
    for (size_t lane = 0; lane < kWord; ++lane)
      word |= static_cast<uint32_t>(flags[first + lane]) << lane;
    bits |= uint64_t{word} << first;
  }
  return bits;
}

/// Looks up the cells of the first `count` lanes, a multiple of kWord, and moves each past what is
/// empty.
LTE_VECTOR_CLONES
Leap leap(const MarkedGrid& grid, const Vec3& a, size_t count, Lanes* lanes) {
  const std::array<int32_t, 3>& size = grid.shape.size;
  const int32_t nx = size[0] - 1, ny = size[1] - 1, nz = size[2] - 1;
  const int32_t step_x = size[1] * size[2], step_y = size[2];
  const int32_t* __restrict clearances = grid.clearance.data();
  const float *dx = lanes->dx.data(), *dy = lanes->dy.data(), *dz = lanes->dz.data(),
              *end = lanes->end.data();
  float* __restrict at = lanes->at.data();
  int32_t* __restrict clearance = lanes->clearance.data();
  int32_t* __restrict tested = lanes->tested.data();
  int32_t cell[kLanes], hits[kLanes], over[kLanes];
  for (size_t lane = 0; lane < count; ++lane) {
    const auto x = static_cast<int32_t>(a.x + dx[lane] * at[lane]);
    const auto y = static_cast<int32_t>(a.y + dy[lane] * at[lane]);
    const auto z = static_cast<int32_t>(a.z + dz[lane] * at[lane]);
    const int32_t cx = std::min(std::max(x, 0), nx);
    const int32_t cy = std::min(std::max(y, 0), ny);
    const int32_t cz = std::min(std::max(z, 0), nz);
    cell[lane] = cx * step_x + cy * step_y + cz;
  }
  // By itself: the compiler gathers nothing, and would leave the rest of the loop scalar as well.
  for (size_t lane = 0; lane < count; ++lane)
    clearance[lane] = clearances[static_cast<size_t>(cell[lane])];
  for (size_t lane = 0; lane < count; ++lane) {
    over[lane] = at[lane] <= end[lane] ? 0 : 1;
    at[lane] += std::max(static_cast<float>(clearance[lane] - 1), kStep);
    hits[lane] = (clearance[lane] < 0 ? 1 : 0) & (clearance[lane] != tested[lane] ? 1 : 0) &
                 (1 - over[lane]);
    tested[lane] = clearance[lane] < 0 ? clearance[lane] : tested[lane];
  }
  return {bits_of(hits, count), bits_of(over, count)};
}

/// Which segments from `a` cross their surfels, or the part of a surfel's plane right beside it.
LTE_VECTOR_CLONES
void cross_surfels(const GridShape& shape, const Vec3& a, Tests* tests) {
  const float own = kOwnCells * shape.cell, radius = kRadiusCells * shape.cell;
  const float *x = tests->x.data(), *y = tests->y.data(), *z = tests->z.data(),
              *nx = tests->nx.data(), *ny = tests->ny.data(), *nz = tests->nz.data(),
              *to_x = tests->to_x.data(), *to_y = tests->to_y.data(), *to_z = tests->to_z.data();
  int32_t* __restrict blocked = tests->blocked.data();
  // Whole words: what is past the last test is never read.
  const size_t count = (tests->count + kWord - 1) / kWord * kWord;
  for (size_t i = 0; i < count; ++i) {
    const float ax = a.x - x[i], ay = a.y - y[i], az = a.z - z[i];
    const float above = ax * nx[i] + ay * ny[i] + az * nz[i];
    const float below =
        (to_x[i] - x[i]) * nx[i] + (to_y[i] - y[i]) * ny[i] + (to_z[i] - z[i]) * nz[i];
    // From the middle to where the plane is crossed, times `span`: nothing is divided by.
    const float span = above - below, reach = radius * span;
    const float off_x = ax * span + (to_x[i] - a.x) * above,
                off_y = ay * span + (to_y[i] - a.y) * above,
                off_z = az * span + (to_z[i] - a.z) * above;
    blocked[i] = (above * below < 0 ? 1 : 0) &
                 (std::min(std::abs(above), std::abs(below)) > own ? 1 : 0) &
                 (off_x * off_x + off_y * off_y + off_z * off_z < reach * reach ? 1 : 0);
  }
}

/// The marches of some segments.
class Marches {
 public:
  Marches(const MarkedGrid& grid, const Vec3& a)
      : grid_(grid), a_(a), in_cells_(grid.shape.place(a)), lanes_{}, tests_{} {}

  /// @param others  kSegments at most
  /// @param visible  1 everywhere; becomes 0 where something is between
  void run(std::span<const Vec3> others, uint8_t* visible) {
    take(others);
    size_t next = 0, width = 0;
    uint64_t live = 0;
    for (; width < kLanes && next < others.size(); ++width, ++next) {
      start(width, next);
      live |= uint64_t{1} << width;
    }
    width = words_of(width);
    while (live != 0) {
      const Leap now = leap(grid_, in_cells_, width, &lanes_);
      const uint64_t blocked = blocked_of(now.hits & live);
      for (uint64_t bits = blocked; bits != 0; bits &= bits - 1)
        visible[lanes_.segment[static_cast<size_t>(std::countr_zero(bits))]] = 0;
      uint64_t over = (now.over | blocked) & live;
      for (; over != 0 && next < others.size(); over &= over - 1, ++next)
        start(static_cast<size_t>(std::countr_zero(over)), next);
      if (over == 0) continue;
      live &= ~over;
      if (words_of(static_cast<size_t>(std::popcount(live))) < width) width = close_ranks(&live);
    }
  }

 private:
  static size_t words_of(size_t lanes) { return (lanes + kWord - 1) / kWord * kWord; }

  void take(std::span<const Vec3> others) {
    for (size_t i = 0; i < others.size(); ++i) {
      segments_.x[i] = others[i].x;
      segments_.y[i] = others[i].y;
      segments_.z[i] = others[i].z;
    }
    aim(grid_.shape, in_cells_, others.size(), &segments_);
  }

  void start(size_t lane, size_t segment) {
    lanes_.set(lane, segments_, segment);
    lanes_.tested[lane] = 0;
    lanes_.segment[lane] = segment;
  }

  /// Those of `hits` whose surfels block.
  uint64_t blocked_of(uint64_t hits) {
    tests_.count = 0;
    for (; hits != 0; hits &= hits - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(hits));
      for (const Surfel& surfel : grid_.marked(lanes_.clearance[lane])) add_test(surfel, lane);
    }
    if (tests_.count == 0) return 0;
    cross_surfels(grid_.shape, a_, &tests_);
    uint64_t blocked = 0;
    for (size_t i = 0; i < tests_.count; ++i)
      blocked |= uint64_t{tests_.blocked[i] != 0} << tests_.lane[i];
    return blocked;
  }

  void add_test(const Surfel& surfel, size_t lane) {
    const size_t i = tests_.count++, segment = lanes_.segment[lane];
    tests_.x[i] = surfel.middle.x;
    tests_.y[i] = surfel.middle.y;
    tests_.z[i] = surfel.middle.z;
    tests_.nx[i] = surfel.normal.x;
    tests_.ny[i] = surfel.normal.y;
    tests_.nz[i] = surfel.normal.z;
    tests_.to_x[i] = segments_.x[segment];
    tests_.to_y[i] = segments_.y[segment];
    tests_.to_z[i] = segments_.z[segment];
    tests_.lane[i] = lane;
  }

  /// Brings the last marches that go on to the front; returns how many lanes they take.
  size_t close_ranks(uint64_t* live) {
    size_t lane = 0;
    const auto count = static_cast<size_t>(std::popcount(*live));
    for (uint64_t behind = *live >> count << count; count < kLanes && behind != 0;
         behind &= behind - 1) {
      while ((*live >> lane & 1) != 0) ++lane;
      move(static_cast<size_t>(std::countr_zero(behind)), lane);
      *live |= uint64_t{1} << lane;
    }
    *live = count < kLanes ? (uint64_t{1} << count) - 1 : *live;
    return words_of(count);
  }

  void move(size_t from, size_t to) {
    lanes_.set(to, lanes_, from);
    lanes_.tested[to] = lanes_.tested[from];
    lanes_.segment[to] = lanes_.segment[from];
  }

  const MarkedGrid& grid_;
  Vec3 a_, in_cells_;
  Segments segments_;
  Lanes lanes_;
  Tests tests_;
};

}  // namespace

void march(const MarkedGrid& grid, const Vec3& a, std::span<const Vec3> others,
           std::span<uint8_t> visible) {
  std::fill(visible.begin(), visible.end(), uint8_t{1});
  Marches marches(grid, a);
  for (size_t first = 0; first < others.size(); first += kSegments) {
    const size_t count = std::min(kSegments, others.size() - first);
    marches.run(others.subspan(first, count), visible.data() + first);
  }
}

}  // namespace lte::radiosity
