#include "lte/pathtrace/auto_camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

constexpr int kEyeCandidates = 256;
constexpr int kEyesScored = 12;
constexpr int kProbes = 48;        ///< directions over the sphere that test an eye point
constexpr float kEnclosed = 0.7f;  ///< share of probes that must hit: a room may lack one wall
constexpr float kFronts = 0.1f;    ///< share of hits on fronts: inside a solid there are none
constexpr int kAzimuths = 16;
constexpr int kGridX = 12, kGridY = 8;
constexpr float kVfov = 62;
/// Radians, slightly down: floors and furniture rather than ceilings.
constexpr float kPitch = -0.12f;
/// Metres; smaller scenes are seen as scale models of such a room.
constexpr float kRoomHeight = 2.5f;

struct Eye {
  Vec3 position;
  float free_distance = 0;  ///< geometric mean of the probes' hit distances
};

/// Evenly spread directions (Fibonacci lattice).
Vec3 probe_direction(int i) {
  const float y = 1 - 2 * (static_cast<float>(i) + 0.5f) / kProbes;
  const float radius = std::sqrt(std::max(0.0f, 1 - y * y));
  const float phi = 2.39996323f * static_cast<float>(i);
  return {radius * std::cos(phi), y, radius * std::sin(phi)};
}

/// Fills `free_distance`; false if the point is in the open, inside a solid or too near a surface.
bool probe_eye(const Bvh& bvh, float unit, float far, Eye* eye) {
  int hits = 0, fronts = 0;
  float log_sum = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = bvh.intersect({eye->position, direction});
    if (hit.valid() && hit.t < 0.3f * unit) return false;
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
    log_sum += std::log(hit.valid() ? hit.t : far);
  }
  eye->free_distance = std::exp(log_sum / kProbes);
  return static_cast<float>(hits) >= kEnclosed * kProbes &&
         static_cast<float>(fronts) >= kFronts * static_cast<float>(hits);
}

std::vector<Eye> find_eyes(const Bvh& bvh, float unit, uint64_t seed) {
  const Bounds& bounds = bvh.bounds();
  const Vec3 extent = bounds.extent();
  const float far = length(extent);
  Rng rng(seed, 0xca3e7a);
  std::vector<Eye> eyes;
  for (int i = 0; i < kEyeCandidates; ++i) {
    const Vec3 start{bounds.low.x + rng.uniform() * extent.x,
                     bounds.low.y + rng.uniform() * extent.y,
                     bounds.low.z + rng.uniform() * extent.z};
    const float height = rng.uniform(1.2f, 1.7f) * unit;
    const Vec3 down{0, -1, 0};
    const Hit floor = bvh.intersect({start, down});
    if (!floor.valid() || std::fabs(floor.normal.y) < 0.7f) continue;
    Eye eye{start + down * (floor.t - height)};
    if (floor.t < height && bvh.occluded({start, {0, 1, 0}, 0, height - floor.t})) continue;
    if (probe_eye(bvh, unit, far, &eye)) eyes.push_back(eye);
  }
  const auto keep = std::min<size_t>(eyes.size(), kEyesScored);
  std::partial_sort(eyes.begin(), eyes.begin() + static_cast<int64_t>(keep), eyes.end(),
                    [](const Eye& a, const Eye& b) { return a.free_distance > b.free_distance; });
  eyes.resize(keep);
  return eyes;
}

/// Larger is better: many pixels on front faces, distances that vary, nothing that fills the view
/// from near by.
float score_view(const Bvh& bvh, const scene::Camera& camera, float unit, float far) {
  float fronts = 0, near = 0, sum = 0, squares = 0;
  for (int y = 0; y < kGridY; ++y) {
    for (int x = 0; x < kGridX; ++x) {
      const Vec3 direction = camera.direction((static_cast<float>(x) + 0.5f) / kGridX,
                                              (static_cast<float>(y) + 0.5f) / kGridY, 1.5f);
      const Hit hit = bvh.intersect({camera.origin, direction});
      const float distance = hit.valid() ? std::max(hit.t, 1e-3f * unit) : far;
      fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1.0f : 0.0f;
      near += distance < 0.8f * unit ? 1.0f : 0.0f;
      const float log_distance = std::log(distance / unit);
      sum += log_distance;
      squares += log_distance * log_distance;
    }
  }
  constexpr float kCount = kGridX * kGridY;
  const float mean = sum / kCount;
  const float spread = std::sqrt(std::max(0.0f, squares / kCount - mean * mean));
  const float front_share = fronts / kCount;
  return front_share * front_share * (0.5f + spread) * std::max(0.1f, 1 + mean) *
         (1 - near / kCount);
}

scene::Camera looking(const Vec3& origin, const Vec3& direction, float distance, float vfov) {
  scene::Camera camera;
  camera.name = "auto";
  camera.origin = origin;
  camera.target = origin + direction * distance;
  camera.up = {0, 1, 0};
  camera.vfov = vfov;
  return camera;
}

scene::Camera outside_view(const Bounds& bounds) {
  if (bounds.empty()) return looking({}, {0, 0, -1}, 1, kVfov);
  constexpr float kOutsideVfov = 45;
  const float radius = std::max(length(bounds.extent()) / 2, 1e-6f);
  const Vec3 away = normalize({0.6f, 0.45f, 1});
  const float distance = radius / std::sin(kOutsideVfov * kPi / 360);
  return looking(bounds.center() + away * distance, -away, distance, kOutsideVfov);
}

}  // namespace

scene::Camera auto_camera(const Bvh& bvh, uint64_t seed) {
  const Bounds& bounds = bvh.bounds();
  if (bounds.empty()) return outside_view(bounds);
  const float unit = std::min(1.0f, bounds.extent().y / kRoomHeight);
  const float far = length(bounds.extent());
  scene::Camera best = outside_view(bounds);
  float best_score = -1;
  if (!(unit > 0)) return best;
  for (const Eye& eye : find_eyes(bvh, unit, seed)) {
    for (int i = 0; i < kAzimuths; ++i) {
      const float azimuth = 2 * kPi * static_cast<float>(i) / kAzimuths;
      const Vec3 direction{std::cos(kPitch) * std::cos(azimuth), std::sin(kPitch),
                           std::cos(kPitch) * std::sin(azimuth)};
      const scene::Camera camera = looking(eye.position, direction, eye.free_distance, kVfov);
      const float score = score_view(bvh, camera, unit, far);
      if (score > best_score) {
        best_score = score;
        best = camera;
      }
    }
  }
  return best;
}

}  // namespace lte::pathtrace
