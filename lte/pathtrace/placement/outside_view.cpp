// Views from outside: of an object, and into a box that lacks a side.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::pathtrace {
namespace {

constexpr float kOutsideVfov = 40;
/// The lens of Cornell's photograph, 35 mm before 25 mm of film.
constexpr float kBoxVfov = 39.3f;
constexpr float kBoxFill = 0.975f;
constexpr float kWidestBox = 2;  ///< width over height of an open side, or the inverse
constexpr int64_t kPoints = 100'000;
/// A subject that is smaller than this part of the scene is framed alone.
constexpr float kSubjectShare = 0.6f;
/// A thing is flat if it is so much thinner than long.
constexpr float kFlat = 0.02f;
constexpr int kGrid = 24;
/// Front faces that another direction than the first must show more.
constexpr float kBetter = 1.25f;
/// A back face counts by so much: some files wind their triangles at random.
constexpr float kBackFace = 0.3f;

/// The camera that looks along `view` and has all points within `fill` of its frame, from as near
/// as can be. In the camera's axes a point (u, v, w) lies in the frame of a camera at (a, b, c) if
/// |u − a| ≤ s (w − c) and |v − b| ≤ t (w − c), which bounds c for each axis by itself.
scene::Camera fit(std::span<const Vec3> points, const Vec3& view, float vfov, float aspect,
                  float fill) {
  const Vec3 up{0, 1, 0};
  const Vec3 right = normalize(cross(view, up)), above = cross(right, view);
  const float half = fill * std::tan(vfov * kPi / 360);
  const std::array<float, 2> slope{half * aspect, half};
  const std::array<Vec3, 2> axes{right, above};
  // Around the first point: far from the origin the sums below would cancel.
  const Vec3 origin = points.front();
  std::array<float, 2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  float nearest = INFINITY, farthest = -INFINITY;
  for (const Vec3& point : points) {
    const Vec3 p = point - origin;
    const float w = dot(p, view);
    nearest = std::min(nearest, w);
    farthest = std::max(farthest, w);
    for (size_t i = 0; i < 2; ++i) {
      const float u = dot(p, axes[i]);
      high[i] = std::max(high[i], u - slope[i] * w);
      low[i] = std::min(low[i], u + slope[i] * w);
    }
  }
  float c = INFINITY;
  for (size_t i = 0; i < 2; ++i) c = std::min(c, (low[i] - high[i]) / (2 * slope[i]));
  // A point, or a line along the view, has no size.
  c = std::min(c, nearest - 1e-3f * std::max(1e-3f, farthest - nearest));
  const Vec3 eye =
      origin + view * c + right * ((low[0] + high[0]) / 2) + above * ((low[1] + high[1]) / 2);
  scene::Camera camera;
  camera.name = "auto";
  camera.origin = eye;
  camera.target = eye + view * ((nearest + farthest) / 2 - c);
  camera.up = up;
  camera.vfov = vfov;
  return camera;
}

std::array<Vec3, 8> corners(const Bounds& bounds) {
  std::array<Vec3, 8> out;
  for (size_t i = 0; i < 8; ++i) {
    out[i] = {(i & 1) != 0 ? bounds.high.x : bounds.low.x,
              (i & 2) != 0 ? bounds.high.y : bounds.low.y,
              (i & 4) != 0 ? bounds.high.z : bounds.low.z};
  }
  return out;
}

/// What a view from outside is to show.
struct Subject {
  std::vector<uint8_t> has;  ///< by instance
  std::vector<Vec3> points;  ///< corners of its triangles, thinned
};

Bounds mesh_bounds(const scene::Mesh& mesh) {
  Bounds bounds;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) bounds.extend(mesh.positions[corner]);
  return bounds;
}

/// Bounds of the corners of a mesh's bounds.
Bounds placed(const Bounds& local, const Affine& to_world) {
  Bounds world;
  if (local.empty()) return world;
  for (const Vec3& corner : corners(local)) world.extend(to_world.point(corner));
  return world;
}

bool is_flat(const Bounds& bounds) {
  const Vec3 e = bounds.extent();
  return std::min({e.x, e.y, e.z}) <= kFlat * max_component(e);
}

bool is_lamp(const scene::Scene& scene, const scene::Instance& instance) {
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  const scene::Material& material = scene.materials[static_cast<size_t>(mesh.material)];
  return material.emissive() && material.emission_texture.texture == scene::kNone;
}

void add_points(const scene::Scene& scene, Subject* subject) {
  int64_t total = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    if (!subject->has[i]) continue;
    const auto mesh = static_cast<size_t>(scene.instances[i].mesh);
    total += static_cast<int64_t>(scene.meshes[mesh].triangles.size());
  }
  const auto step = static_cast<size_t>(std::max<int64_t>(1, 3 * total / kPoints));
  size_t next = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    if (!subject->has[i]) continue;
    const scene::Instance& instance = scene.instances[i];
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const size_t count = 3 * mesh.triangles.size();
    for (; next < count; next += step) {
      const uint32_t corner = mesh.triangles[next / 3][next % 3];
      subject->points.push_back(instance.to_world.point(mesh.positions[corner]));
    }
    next -= count;
  }
}

Subject find_subject(const scene::Scene& scene) {
  Subject subject;
  Bounds all, wanted;
  std::vector<Bounds> meshes;
  for (const scene::Mesh& mesh : scene.meshes) meshes.push_back(mesh_bounds(mesh));
  for (const scene::Instance& instance : scene.instances) {
    const Bounds bounds = placed(meshes[static_cast<size_t>(instance.mesh)], instance.to_world);
    const bool has = !bounds.empty() && !is_flat(bounds) && !is_lamp(scene, instance);
    subject.has.push_back(has ? 1 : 0);
    if (bounds.empty()) continue;
    for (Bounds* sum : {&all, has ? &wanted : &all}) {
      sum->extend(bounds.low);
      sum->extend(bounds.high);
    }
  }
  if (wanted.empty() || length(wanted.extent()) > kSubjectShare * length(all.extent()))
    std::fill(subject.has.begin(), subject.has.end(), uint8_t{1});
  add_points(scene, &subject);
  return subject;
}

/// Share of a grid of rays that meet the subject first, back faces counted less.
float visible_share(const Bvh& bvh, const Subject& subject, const scene::Camera& camera,
                    float aspect) {
  float sum = 0;
  for (int y = 0; y < kGrid; ++y) {
    for (int x = 0; x < kGrid; ++x) {
      const Vec3 direction = camera.direction((static_cast<float>(x) + 0.5f) / kGrid,
                                              (static_cast<float>(y) + 0.5f) / kGrid, aspect);
      const Hit hit = bvh.intersect({camera.origin, direction});
      if (!hit.valid() || !subject.has[static_cast<size_t>(hit.instance)]) continue;
      sum += dot(hit.normal, direction) < 0 ? 1 : kBackFace;
    }
  }
  return sum / (kGrid * kGrid);
}

}  // namespace

scene::Camera outside_view(const Bvh& bvh, float aspect) {
  const Subject subject = find_subject(bvh.scene());
  if (subject.points.empty())
    return fit(std::array<Vec3, 1>{}, {0, 0, -1}, kOutsideVfov, aspect, kOutsideFill);
  scene::Camera best;
  float best_share = -1;
  constexpr float kFirst = 0.54f;  // radians from +Z to +X: a little from the right
  for (const float elevation : {0.37f, 0.75f}) {
    for (int i = 0; i < 8; ++i) {
      const float azimuth = kFirst + kPi / 4 * static_cast<float>(i);
      const Vec3 away{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                      std::cos(elevation) * std::cos(azimuth)};
      const scene::Camera camera = fit(subject.points, -away, kOutsideVfov, aspect, kOutsideFill);
      const float share = visible_share(bvh, subject, camera, aspect);
      if (best_share >= 0 && share <= kBetter * best_share) continue;
      best = camera;
      best_share = share;
    }
  }
  return best;
}

std::optional<scene::Camera> open_side_view(const Bvh& bvh, const FreeSpace& space, float aspect) {
  int side = -1;
  for (const int candidate : {0, 1, 4, 5}) {
    const float open = space.open[static_cast<size_t>(candidate)];
    if (open > kClosed && (open < kOpen || side >= 0)) return std::nullopt;
    if (open >= kOpen) side = candidate;
  }
  const bool lid_is_clear = space.above() <= kClosed || space.above() >= kOpen;
  if (side < 0 || space.below() > kClosed || !lid_is_clear) return std::nullopt;
  const Vec3 extent = bvh.bounds().extent();
  const float ratio = (side < 2 ? extent.z : extent.x) / extent.y;
  if (!(ratio <= kWidestBox && ratio >= 1 / kWidestBox)) return std::nullopt;
  Vec3 view{};
  view[side / 2] = side % 2 == 0 ? 1.0f : -1.0f;  // from −x towards +x, say
  return fit(corners(bvh.bounds()), view, kBoxVfov, aspect, kBoxFill);
}

}  // namespace lte::pathtrace
