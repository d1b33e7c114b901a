// Views from inside: eye points that stand on a floor in an enclosure, scored by what they see.
#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/base/random.h"
#include "lte/pathtrace/auto_camera.h"

namespace lte::pathtrace {
namespace {

constexpr int kEyeCandidates = 256;  ///< in one go
constexpr int kMostGoes = 16;        ///< until enough of them are indoors: a small house in a field
constexpr int kEnoughIndoors = 4;
constexpr int kEyesScored = 12;
constexpr int kProbes = 48;        ///< directions over the sphere that test an eye point
constexpr float kEnclosed = 0.7f;  ///< share of probes that must hit: a room may lack one wall
constexpr float kIndoors = 0.85f;  ///< the same for a room with all its walls
constexpr float kFronts = 0.1f;    ///< share of hits on fronts: inside a solid there are none
constexpr float kMostlyFronts = 0.5f;
constexpr float kHighestCeiling = 20;  ///< metres above the eye; a dome of sky is farther away
/// Probes so near the horizon ask for walls.
constexpr float kNearHorizon = 0.35f;
constexpr int kAzimuths = 16;
constexpr int kGridX = 12, kGridY = 8;
constexpr float kVfov = 62;
/// Radians, slightly down: floors and furniture rather than ceilings.
constexpr float kPitch = -0.12f;
/// Metres; scenes that are lower are seen as scale models of such a room.
constexpr float kRoomHeight = 2.5f;
/// Units; rooms that are higher are not in metres, and seen in proportion.
constexpr float kHighestRoom = 60;
/// Units; a lower thing with a hollow in it is a vessel, not a room, unless it is closed all round.
constexpr float kLowestOpenRoom = 1.8f;
/// Metres; what rises by so much over the floor stands on it and is not one.
constexpr float kLowestFurniture = 0.05f, kHighestFurniture = 1.3f;

/// Where an eye may stand, from worst to best.
enum class Place { Nowhere, BetweenWalls, Enclosed, Indoors };

struct Eye {
  Vec3 position;
  float free_distance = 0;  ///< geometric mean of the probes' hit distances
  Place place = Place::Nowhere;
  float lowest_floor = INFINITY;  ///< height of the lowest level surface in sight
};

/// Evenly spread directions (Fibonacci lattice).
Vec3 probe_direction(int i) {
  const float y = 1 - 2 * (static_cast<float>(i) + 0.5f) / kProbes;
  const float radius = std::sqrt(std::max(0.0f, 1 - y * y));
  const float phi = 2.39996323f * static_cast<float>(i);
  return {radius * std::cos(phi), y, radius * std::sin(phi)};
}

struct Search {
  const Bvh& bvh;
  float unit;        ///< what counts as a metre
  float far;         ///< the distance of a miss
  bool surrounded;   ///< the scene has walls around it: what is hollow in it is no vessel
  bool no_ceilings;  ///< in the whole scene: walls alone will do
};

/// What surrounds a point. Nowhere if it is in the open, inside a solid or too near a surface.
Place judge(const Search& search, Eye* eye) {
  int hits = 0, fronts = 0, level = 0, walls = 0;
  float log_sum = 0;
  eye->lowest_floor = INFINITY;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = search.bvh.intersect({eye->position, direction});
    if (hit.valid() && hit.t < 0.3f * search.unit) return Place::Nowhere;
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
    log_sum += std::log(hit.valid() ? hit.t : search.far);
    if (hit.valid() && direction.y < 0 && hit.normal.y > 0.9f)
      eye->lowest_floor = std::min(eye->lowest_floor, eye->position.y + hit.t * direction.y);
    if (std::fabs(direction.y) > kNearHorizon) continue;
    ++level;
    walls += hit.valid() ? 1 : 0;
  }
  eye->free_distance = std::exp(log_sum / kProbes);
  const auto share = [](int part, int whole) {
    return static_cast<float>(part) / static_cast<float>(std::max(1, whole));
  };
  if (share(fronts, hits) < kFronts) return Place::Nowhere;
  const float enclosed = share(hits, kProbes);
  const Hit ceiling = search.bvh.intersect({eye->position, {0, 1, 0}});
  if (enclosed >= kIndoors && share(fronts, hits) >= kMostlyFronts && ceiling.valid() &&
      ceiling.t <= kHighestCeiling * search.unit) {
    return Place::Indoors;
  }
  if (!search.surrounded) return Place::Nowhere;
  if (enclosed >= kEnclosed) return Place::Enclosed;
  return search.no_ceilings && share(walls, level) >= kIndoors ? Place::BetweenWalls
                                                               : Place::Nowhere;
}

void add_eyes(const Search& search, Rng* rng, std::vector<Eye>* eyes) {
  const Bounds& bounds = search.bvh.bounds();
  const Vec3 extent = bounds.extent();
  for (int i = 0; i < kEyeCandidates; ++i) {
    const Vec3 start{bounds.low.x + rng->uniform() * extent.x,
                     bounds.low.y + rng->uniform() * extent.y,
                     bounds.low.z + rng->uniform() * extent.z};
    const float height = rng->uniform(1.2f, 1.7f) * search.unit;
    const Vec3 down{0, -1, 0};
    const Hit floor = search.bvh.intersect({start, down});
    if (!floor.valid() || std::fabs(floor.normal.y) < 0.7f) continue;
    Eye eye{start + down * (floor.t - height)};
    if (floor.t < height && search.bvh.occluded({start, {0, 1, 0}, 0, height - floor.t})) continue;
    eye.place = judge(search, &eye);
    // What the point is above may be a table, with the floor in sight beside it.
    const float drop = eye.position.y - height - eye.lowest_floor;
    if (drop > kLowestFurniture * search.unit && drop < kHighestFurniture * search.unit) {
      eye.position.y -= drop;
      eye.place = judge(search, &eye);
    }
    if (eye.place != Place::Nowhere) eyes->push_back(eye);
  }
}

std::vector<Eye> find_eyes(const Search& search, uint64_t seed) {
  Rng rng(seed, 0xca3e7a);
  std::vector<Eye> eyes;
  const auto indoors = [](const Eye& eye) { return eye.place == Place::Indoors; };
  for (int go = 0; go < kMostGoes; ++go) {
    add_eyes(search, &rng, &eyes);
    if (std::count_if(eyes.begin(), eyes.end(), indoors) >= kEnoughIndoors) break;
  }
  Place best = Place::Nowhere;
  for (const Eye& eye : eyes) best = std::max(best, eye.place);
  std::erase_if(eyes, [&](const Eye& eye) { return eye.place != best; });
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

scene::Camera looking(const Vec3& origin, const Vec3& direction, float distance) {
  scene::Camera camera;
  camera.name = "auto";
  camera.origin = origin;
  camera.target = origin + direction * distance;
  camera.up = {0, 1, 0};
  camera.vfov = kVfov;
  return camera;
}

/// What counts as a metre at eye height.
float room_unit(float room_height, float scene_height) {
  const float height = room_height > 0 ? room_height : scene_height;
  if (height > kHighestRoom) return height / kRoomHeight;
  return std::min(1.0f, scene_height / kRoomHeight);
}

}  // namespace

std::optional<scene::Camera> inside_view(const Bvh& bvh, const FreeSpace& space, uint64_t seed) {
  const Vec3 extent = bvh.bounds().extent();
  if (extent.y < kLowestOpenRoom && !space.closed()) return std::nullopt;
  const Search search{bvh, room_unit(space.room_height, extent.y), length(extent),
                      space.surrounded(), space.above() >= kOpen / 2};
  if (!(search.unit > 0)) return std::nullopt;
  std::optional<scene::Camera> best;
  float best_score = -1;
  for (const Eye& eye : find_eyes(search, seed)) {
    for (int i = 0; i < kAzimuths; ++i) {
      const float azimuth = 2 * kPi * static_cast<float>(i) / kAzimuths;
      const Vec3 direction{std::cos(kPitch) * std::cos(azimuth), std::sin(kPitch),
                           std::cos(kPitch) * std::sin(azimuth)};
      const scene::Camera camera = looking(eye.position, direction, eye.free_distance);
      const float score = score_view(bvh, camera, search.unit, search.far);
      if (score <= best_score) continue;
      best_score = score;
      best = camera;
    }
  }
  return best;
}

}  // namespace lte::pathtrace
