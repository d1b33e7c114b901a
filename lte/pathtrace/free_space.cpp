#include "lte/pathtrace/free_space.h"

#include <algorithm>
#include <cmath>
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

Vec3 random_point(const Bounds& bounds, Rng* rng) {
  const Vec3 e = bounds.extent();
  const float x = rng->uniform(), y = rng->uniform(), z = rng->uniform();
  return bounds.low + Vec3{x * e.x, y * e.y, z * e.z};
}

/// Looks from outside towards points of the bounding box.
float outward_share(const Bvh& bvh) {
  const float away = 2 * length(bvh.bounds().extent());
  Rng rng(1, 0x5afe);
  int hits = 0, fronts = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 point = random_point(bvh.bounds(), &rng);
    const float y = 2 * rng.uniform() - 1, turn = 2 * kPi * rng.uniform();
    const float level = std::sqrt(std::max(0.0f, 1 - y * y));
    const Vec3 direction{level * std::cos(turn), y, level * std::sin(turn)};
    const Hit hit = bvh.intersect({point - direction * away, direction});
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
  }
  return static_cast<float>(fronts) / static_cast<float>(std::max(1, hits));
}

}  // namespace

bool FreeSpace::surrounded() const {
  int walls = 0;
  for (const size_t side : {0, 1, 4, 5}) walls += open[side] <= kClosed ? 1 : 0;
  return walls >= 3 && below() <= kClosed;
}

bool FreeSpace::closed() const { return *std::max_element(open.begin(), open.end()) <= kClosed; }

Vec3 probe_direction(int i) {
  const float y = 1 - 2 * (static_cast<float>(i) + 0.5f) / kProbes;
  const float across = std::sqrt(std::max(0.0f, 1 - y * y));
  const float phi = 2.39996323f * static_cast<float>(i);
  return {across * std::cos(phi), y, across * std::sin(phi)};
}

FreeSpace survey(const Bvh& bvh) {
  FreeSpace out;
  const Bounds& bounds = bvh.bounds();
  if (bounds.empty()) return out;
  out.outward = outward_share(bvh);
  Rng rng(0, 0x5afe);
  std::vector<float> heights;
  std::array<int, 6> escaped{};
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 point = random_point(bounds, &rng);
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
