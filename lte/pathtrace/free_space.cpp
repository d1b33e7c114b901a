#include "lte/pathtrace/free_space.h"

#include <algorithm>
#include <vector>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

constexpr int kPoints = 512;
/// Share of the points that must stand between floor and ceiling.
constexpr float kRoofed = 0.05f;
/// Cosine to the vertical: floors and ceilings are level, unlike the dome of a sky.
constexpr float kLevel = 0.98f;

Vec3 axis_direction(int side) {
  Vec3 direction{};
  direction[side / 2] = side % 2 == 0 ? -1.0f : 1.0f;
  return direction;
}

}  // namespace

bool FreeSpace::surrounded() const {
  int walls = 0;
  for (const size_t side : {0, 1, 4, 5}) walls += open[side] <= kClosed ? 1 : 0;
  return walls >= 3 && below() <= kClosed;
}

bool FreeSpace::closed() const { return *std::max_element(open.begin(), open.end()) <= kClosed; }

FreeSpace survey(const Bvh& bvh) {
  FreeSpace out;
  const Bounds& bounds = bvh.bounds();
  if (bounds.empty()) return out;
  const Vec3 extent = bounds.extent();
  Rng rng(0, 0x5afe);
  std::vector<float> heights;
  std::array<int, 6> escaped{};
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 point{bounds.low.x + rng.uniform() * extent.x,
                     bounds.low.y + rng.uniform() * extent.y,
                     bounds.low.z + rng.uniform() * extent.z};
    std::array<Hit, 6> hits;
    for (int side = 0; side < 6; ++side) {
      hits[static_cast<size_t>(side)] = bvh.intersect({point, axis_direction(side)});
      escaped[static_cast<size_t>(side)] += hits[static_cast<size_t>(side)].valid() ? 0 : 1;
    }
    const Hit &floor = hits[2], &ceiling = hits[3];
    if (floor.valid() && ceiling.valid() && floor.normal.y > kLevel && ceiling.normal.y < -kLevel)
      heights.push_back(floor.t + ceiling.t);
  }
  for (size_t side = 0; side < 6; ++side)
    out.open[side] = static_cast<float>(escaped[side]) / kPoints;
  if (static_cast<float>(heights.size()) < kRoofed * kPoints) return out;
  const auto middle = heights.begin() + static_cast<int64_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  out.room_height = *middle;
  return out;
}

const char* likely_unit(float room_height) {
  constexpr float kLowest = 150;
  if (room_height < kLowest || room_height >= 100 * kLowest) return nullptr;
  return room_height < 10 * kLowest ? "centimetres" : "millimetres";
}

}  // namespace lte::pathtrace
