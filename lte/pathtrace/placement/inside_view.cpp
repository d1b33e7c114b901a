// Views from inside: eye points that stand on a floor in an enclosure, scored by what they see.
#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/placement/room_places.h"

namespace lte::pathtrace {
namespace {

constexpr int kEnoughIndoors = 12;
constexpr int kEyesScored = 24;
/// Units: what is farther away, such as all that a door or a window shows, counts as so far.
constexpr float kFarthest = 10;
/// Of a picture that is all farther away than that.
constexpr float kOutOfDoors = 0.5f;
/// Of a view in a room without a lamp in sight.
constexpr float kUnlit = 0.25f;
constexpr size_t kLamps = 256;
constexpr int kAzimuths = 16;
constexpr int kGridX = 12, kGridY = 8;
constexpr float kVfov = 62;
/// Radians, slightly down: floors and furniture rather than ceilings.
constexpr float kPitch = -0.12f;

/// A place, and whether a lamp is in sight there.
struct Eye {
  RoomPlace place;
  bool lit = true;
};

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
bool is_lit(const Bvh& bvh, const std::vector<Vec3>& lamps, const RoomPlace& place) {
  const scene::Scene& scene = bvh.scene();
  const bool sky = scene.environment.has_value() ||
                   std::any_of(scene.lights.begin(), scene.lights.end(), [](const auto& light) {
                     return light.kind == scene::LightKind::Directional;
                   });
  if ((lamps.empty() && !sky) || (sky && place.sees_sky)) return true;
  return std::any_of(lamps.begin(), lamps.end(), [&](const Vec3& lamp) {
    return !bvh.occluded({place.eye, lamp - place.eye, 0, 0.98f});
  });
}

std::vector<Eye> find_eyes(const Bvh& bvh, const FreeSpace& space, uint64_t seed) {
  const std::vector<Vec3> lamps = lamp_points(bvh.scene());
  std::vector<Eye> eyes;
  for (const RoomPlace& place : find_room_places(bvh, space, seed, kEnoughIndoors))
    eyes.push_back({place, is_lit(bvh, lamps, place)});
  const auto keep = std::min<size_t>(eyes.size(), kEyesScored);
  std::partial_sort(eyes.begin(), eyes.begin() + static_cast<int64_t>(keep), eyes.end(),
                    [](const Eye& a, const Eye& b) {
                      return a.lit != b.lit ? a.lit : a.place.free_distance > b.place.free_distance;
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

}  // namespace

std::optional<scene::Camera> inside_view(const Bvh& bvh, const FreeSpace& space, uint64_t seed) {
  std::optional<scene::Camera> best;
  float best_score = -1;
  for (const Eye& eye : find_eyes(bvh, space, seed)) {
    const float lit = eye.lit ? 1 : kUnlit;
    for (int i = 0; i < kAzimuths; ++i) {
      const float azimuth = 2 * kPi * static_cast<float>(i) / kAzimuths;
      const Vec3 direction{std::cos(kPitch) * std::cos(azimuth), std::sin(kPitch),
                           std::cos(kPitch) * std::sin(azimuth)};
      const scene::Camera camera = looking(eye.place.eye, direction, eye.place.free_distance);
      const float score = lit * score_view(bvh, camera, space.unit);
      if (score <= best_score) continue;
      best_score = score;
      best = camera;
    }
  }
  return best;
}

}  // namespace lte::pathtrace
