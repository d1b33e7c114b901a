#include "lte/pathtrace/placement/free_space.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

constexpr int kPoints = 512;
/// Share of the points that must stand between floor and ceiling.
constexpr float kRoofed = 0.05f;
/// Cosine to the vertical: floors and ceilings are level, unlike the dome of a sky.
constexpr float kLevel = 0.98f;
/// Units.
constexpr float kRoomHeight = 2.5f, kHighestCeiling = 20, kHighestRoom = 60;
constexpr float kElbows = 0.3f;
constexpr int kMaxLayers = 64;

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

float unit_of(float room_height, float scene_height) {
  const float height = room_height > 0 ? room_height : scene_height;
  if (height > kHighestRoom) return height / kRoomHeight;
  return std::min(1.0f, scene_height / kRoomHeight);
}

/// A surface that a vertical line meets.
struct Layer {
  float height = 0;
  float rise = 0;  ///< y of its normal
};

/// From the top down.
std::vector<Layer> layers_at(const Bvh& bvh, float x, float z) {
  const Bounds& bounds = bvh.bounds();
  const float step = 1e-5f * std::max(bounds.extent().y, std::fabs(bounds.high.y));
  std::vector<Layer> layers;
  for (float y = bounds.high.y + step; layers.size() < kMaxLayers;) {
    const Hit hit = bvh.intersect({{x, y, z}, {0, -1, 0}});
    if (!hit.valid()) break;
    y -= hit.t;
    layers.push_back({y, hit.normal.y});
    y -= step;
  }
  return layers;
}

/// Whether a person has room on a floor, below walls and a ceiling, and not inside of a solid.
bool can_stand(const Bvh& bvh, const Vec3& floor, float unit) {
  constexpr int kTurns = 8;
  int backs = 0;
  for (const float height : {0.9f, 1.5f}) {
    const Vec3 body = floor + Vec3{0, height * unit, 0};
    for (int i = 0; i < kTurns; ++i) {
      const float turn = 2 * kPi / kTurns * static_cast<float>(i);
      const Vec3 direction{std::cos(turn), 0, std::sin(turn)};
      const Hit hit = bvh.intersect({body, direction});
      if (hit.valid() && hit.t < kElbows * unit) return false;
      backs += hit.valid() && dot(hit.normal, direction) > 0 ? 1 : 0;
    }
  }
  return backs <= kTurns && is_enclosed(bvh, floor + Vec3{0, 1.5f * unit, 0});
}

/// FreeSpace::standing.
float standing_share(const Bvh& bvh, float unit) {
  const Bounds& bounds = bvh.bounds();
  const Vec3 extent = bounds.extent();
  Rng rng(2, 0x5afe);
  int roofed = 0, standing = 0;
  for (int i = 0; i < kPoints; ++i) {
    const float x = bounds.low.x + rng.uniform() * extent.x;
    const float z = bounds.low.z + rng.uniform() * extent.z;
    const std::vector<Layer> layers = layers_at(bvh, x, z);
    if (layers.empty()) continue;
    if (layers.front().height - layers.back().height < kLowestRoom * unit) continue;
    ++roofed;
    for (size_t k = 1; k < layers.size(); ++k) {
      const Layer &ceiling = layers[k - 1], &floor = layers[k];
      const float height = ceiling.height - floor.height;
      if (height < kLowestRoom * unit || height > kHighestCeiling * unit) continue;
      const bool solid = ceiling.rise > 0 && floor.rise < 0;
      if (std::fabs(floor.rise) < kLevel || solid) continue;
      if (!can_stand(bvh, {x, floor.height, z}, unit)) continue;
      ++standing;
      break;
    }
  }
  return static_cast<float>(standing) / static_cast<float>(std::max(1, roofed));
}

float median_height(std::vector<float> heights) {
  if (static_cast<float>(heights.size()) < kRoofed * kPoints) return 0;
  const auto middle = heights.begin() + static_cast<int64_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

}  // namespace

bool FreeSpace::surrounded() const {
  int walls = 0;
  for (const size_t side : {0, 1, 4, 5}) walls += open[side] <= kClosed ? 1 : 0;
  return walls >= 3 && below() <= kClosed;
}

bool FreeSpace::closed() const { return *std::max_element(open.begin(), open.end()) <= kClosed; }

bool FreeSpace::has_rooms() const { return !shows_outside() || standing >= kStanding; }

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
  out.room_height = median_height(std::move(heights));
  out.unit = unit_of(out.room_height, bounds.extent().y);
  if (out.unit > 0) out.standing = standing_share(bvh, out.unit);
  return out;
}

bool is_enclosed(const Bvh& bvh, const Vec3& place) {
  int hits = 0, fronts = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = bvh.intersect({place, direction});
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
  }
  return static_cast<float>(hits) >= kEnclosed * kProbes &&
         static_cast<float>(fronts) >= kFronts * static_cast<float>(hits);
}

const char* likely_unit(float room_height) {
  constexpr float kLowest = 150;
  if (room_height < kLowest || room_height >= 100 * kLowest) return nullptr;
  return room_height < 10 * kLowest ? "centimetres" : "millimetres";
}

}  // namespace lte::pathtrace
