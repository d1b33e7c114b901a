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
constexpr int kEnoughIndoors = 12;
constexpr int kEyesScored = 24;
/// Share of probes that must hit in a room with all its walls.
constexpr float kIndoors = 0.85f;
constexpr float kMostlyFronts = 0.5f;
constexpr float kHighestCeiling = 20;  ///< metres above the eye; a dome of sky is farther away
/// Probes so near the horizon ask for walls: windows take some of a room's, a garden has few.
constexpr float kNearHorizon = 0.35f;
constexpr float kWalls = 0.75f;
/// Metres: what is farther away, such as all that a door or a window shows, counts as so far.
constexpr float kFarthest = 10;
/// Of a picture that is all farther away than that.
constexpr float kOutOfDoors = 0.5f;
/// Share of a room's surfaces that are level or upright. A vessel has less, and a house has both.
constexpr float kSquare = 0.5f;
/// Of a view in a room without a lamp in sight.
constexpr float kUnlit = 0.25f;
constexpr size_t kLamps = 256;
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
  bool sees_sky = false, lit = true;
  float lowest_floor = INFINITY;  ///< height of the lowest level surface in sight
};

struct Search {
  const Bvh& bvh;
  float unit;        ///< what counts as a metre
  bool outward;      ///< the scene shows its front faces to those outside
  bool surrounded;   ///< the scene has walls around it
  bool no_ceilings;  ///< in the whole scene: walls alone will do
};

/// What surrounds a point. Nowhere if it is in the open, inside a solid or too near a surface.
Place judge(const Search& search, Eye* eye) {
  int hits = 0, fronts = 0, level = 0, walls = 0, square = 0;
  float log_sum = 0;
  eye->lowest_floor = INFINITY;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = search.bvh.intersect({eye->position, direction});
    if (hit.valid() && hit.t < 0.3f * search.unit) return Place::Nowhere;
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
    log_sum += std::log(std::min(hit.t, kFarthest * search.unit));
    const float rise = std::fabs(hit.normal.y);
    square += hit.valid() && (rise > 0.98f || rise < 0.05f) ? 1 : 0;
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
  eye->sees_sky = hits < kProbes;
  if (share(fronts, hits) < kFronts) return Place::Nowhere;
  if (search.outward && share(square, hits) < kSquare) return Place::Nowhere;
  const float enclosed = share(hits, kProbes);
  const Hit ceiling = search.bvh.intersect({eye->position, {0, 1, 0}});
  if (enclosed >= kIndoors && share(walls, level) >= kWalls &&
      share(fronts, hits) >= kMostlyFronts && ceiling.valid() &&
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

/// A few places on each lamp.
std::vector<Vec3> lamp_points(const scene::Scene& scene) {
  std::vector<Vec3> points;
  for (const scene::PunctualLight& light : scene.lights)
    if (light.kind != scene::LightKind::Directional) points.push_back(light.position);
  for (const scene::Instance& instance : scene.instances) {
    if (instance.light_group == scene::kNone) continue;
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const size_t step = mesh.triangles.size() / 4 + 1;
    for (size_t t = 0; t < mesh.triangles.size(); t += step) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 sum = mesh.positions[a] + mesh.positions[b] + mesh.positions[c];
      points.push_back(instance.to_world.point(sum / 3));
    }
  }
  if (points.size() <= kLamps) return points;
  std::vector<Vec3> some;
  for (size_t i = 0; i < kLamps; ++i) some.push_back(points[i * points.size() / kLamps]);
  return some;
}

/// Whether light falls into the place of an eye, as far as one can tell from there.
bool is_lit(const Bvh& bvh, const std::vector<Vec3>& lamps, const Eye& eye) {
  const scene::Scene& scene = bvh.scene();
  const bool sky = scene.environment.has_value() ||
                   std::any_of(scene.lights.begin(), scene.lights.end(), [](const auto& light) {
                     return light.kind == scene::LightKind::Directional;
                   });
  if ((lamps.empty() && !sky) || (sky && eye.sees_sky)) return true;
  return std::any_of(lamps.begin(), lamps.end(), [&](const Vec3& lamp) {
    return !bvh.occluded({eye.position, lamp - eye.position, 0, 0.98f});
  });
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
  const std::vector<Vec3> lamps = lamp_points(search.bvh.scene());
  for (Eye& eye : eyes) eye.lit = is_lit(search.bvh, lamps, eye);
  const auto keep = std::min<size_t>(eyes.size(), kEyesScored);
  std::partial_sort(eyes.begin(), eyes.begin() + static_cast<int64_t>(keep), eyes.end(),
                    [](const Eye& a, const Eye& b) {
                      return a.lit != b.lit ? a.lit : a.free_distance > b.free_distance;
                    });
  eyes.resize(keep);
  return eyes;
}

/// Larger is better: many pixels on front faces, distances and things that vary, nothing that fills
/// the view from near by.
float score_view(const Bvh& bvh, const scene::Camera& camera, float unit) {
  float fronts = 0, near = 0, beyond = 0, sum = 0, squares = 0;
  std::vector<int> things;
  for (int y = 0; y < kGridY; ++y) {
    for (int x = 0; x < kGridX; ++x) {
      const Vec3 direction = camera.direction((static_cast<float>(x) + 0.5f) / kGridX,
                                              (static_cast<float>(y) + 0.5f) / kGridY, 1.5f);
      const Hit hit = bvh.intersect({camera.origin, direction});
      const float distance = std::clamp(hit.t, 1e-3f * unit, kFarthest * unit);
      fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1.0f : 0.0f;
      if (hit.valid()) things.push_back(hit.instance);
      beyond += hit.t > kFarthest * unit ? 1.0f : 0.0f;
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
  std::sort(things.begin(), things.end());
  const auto different = std::unique(things.begin(), things.end()) - things.begin();
  const float variety = 1 + 0.25f * std::log2(1 + static_cast<float>(different));
  return front_share * front_share * (0.5f + spread) * std::max(0.1f, 1 + mean) * variety *
         (1 - near / kCount) * (1 - (1 - kOutOfDoors) * beyond / kCount);
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
  const Search search{bvh, room_unit(space.room_height, extent.y), space.outward > 0.5f,
                      space.surrounded(), space.above() >= kOpen / 2};
  if (!(search.unit > 0)) return std::nullopt;
  std::optional<scene::Camera> best;
  float best_score = -1;
  for (const Eye& eye : find_eyes(search, seed)) {
    const float lit = eye.lit ? 1 : kUnlit;
    for (int i = 0; i < kAzimuths; ++i) {
      const float azimuth = 2 * kPi * static_cast<float>(i) / kAzimuths;
      const Vec3 direction{std::cos(kPitch) * std::cos(azimuth), std::sin(kPitch),
                           std::cos(kPitch) * std::sin(azimuth)};
      const scene::Camera camera = looking(eye.position, direction, eye.free_distance);
      const float score = lit * score_view(bvh, camera, search.unit);
      if (score <= best_score) continue;
      best_score = score;
      best = camera;
    }
  }
  return best;
}

}  // namespace lte::pathtrace
