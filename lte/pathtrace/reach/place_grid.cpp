#include "lte/pathtrace/reach/place_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

/// Of two places in one plane either lies on the other's side, but for rounding: so far below a
/// surface, over the radius of a search, still counts as on its side.
constexpr float kBelow = 1e-3f;

using CellNumber = std::array<int64_t, 3>;

uint64_t key_of(const CellNumber& cell) {
  const auto part = [](int64_t c) { return static_cast<uint64_t>(c + (1 << 20)) & 0x1fffff; };
  return part(cell[0]) << 42 | part(cell[1]) << 21 | part(cell[2]);
}

/// @param x  in cells
int64_t cell_along(float x) { return static_cast<int64_t>(std::clamp(std::floor(x), -1e6f, 1e6f)); }

}  // namespace

PlaceGrid::PlaceGrid(const std::vector<Place>& places, std::span<const uint32_t> members,
                     float radius)
    : radius_(radius) {
  const float edge = 2 * radius_;
  std::vector<std::pair<uint64_t, uint32_t>> order;
  order.reserve(members.size());
  for (const uint32_t number : members) {
    const Vec3 at = places[number].origin / edge;
    order.emplace_back(key_of({cell_along(at.x), cell_along(at.y), cell_along(at.z)}), number);
  }
  std::sort(order.begin(), order.end());
  entries_.reserve(order.size());
  for (const auto& [key, number] : order)
    entries_.push_back({places[number].origin, places[number].side, number});
  slots_.resize(std::bit_ceil(2 * order.size() + 1));
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const uint64_t key = order[begin].first;
    while (end < order.size() && order[end].first == key) ++end;
    size_t slot = mix_bits(key) & (slots_.size() - 1);
    while (slots_[slot].begin != slots_[slot].end) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = {key, static_cast<uint32_t>(begin), static_cast<uint32_t>(end)};
  }
}

std::array<uint64_t, 8> PlaceGrid::cells_around(const Vec3& point) const {
  const Vec3 at = point / (2 * radius_);
  std::array<CellNumber, 2>
      reach;  // the cell that the point is in, and the neighbours nearest to it
  for (size_t axis = 0; axis < 3; ++axis) {
    const float x = at[static_cast<int>(axis)];
    reach[0][axis] = cell_along(x);
    reach[1][axis] = reach[0][axis] + (x - std::floor(x) < 0.5f ? -1 : 1);
  }
  std::array<uint64_t, 8> keys;
  for (size_t k = 0; k < keys.size(); ++k)
    keys[k] = key_of({reach[k & 1][0], reach[k >> 1 & 1][1], reach[k >> 2][2]});
  return keys;
}

PlaceGrid::Cell PlaceGrid::find(uint64_t key) const {
  for (size_t slot = mix_bits(key) & (slots_.size() - 1);;
       slot = (slot + 1) & (slots_.size() - 1)) {
    const Cell& cell = slots_[slot];
    if (cell.begin == cell.end || cell.key == key) return cell;
  }
}

bool PlaceGrid::face_each_other(const PathVertex& vertex, const Entry& entry) const {
  const Vec3 way = entry.position - vertex.position;
  const float below = -kBelow * radius_;
  return dot(way, way) <= radius_ * radius_ && dot(way, vertex.side) >= below &&
         -dot(way, entry.side) >= below;
}

}  // namespace lte::pathtrace
