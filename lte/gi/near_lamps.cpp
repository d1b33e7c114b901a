#include "lte/gi/near_lamps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "lte/base/random.h"
#include "lte/scene/triangle.h"

namespace lte::gi {
namespace {

/// Of the mean normal of a lamp, above which it shines one way.
constexpr float kOneWay = 0.5f;

/// Emissive triangles of one cube.
struct Cluster {
  double area = 0;
  Vec3 weighted, axis;  ///< Σ area · middle, Σ area · normal
  bool two_sided = false;
};

float largest_edge(const scene::WorldTriangle& t) {
  return std::max({length(t.p1 - t.p0), length(t.p2 - t.p1), length(t.p0 - t.p2)});
}

}  // namespace

NearLamps::NearLamps(const scene::Scene& scene, float reach) : reach_(reach) {
  using Cube = std::tuple<int64_t, int64_t, int64_t>;
  std::map<Cube, Cluster> clusters;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const scene::Material& material = scene.materials[static_cast<size_t>(mesh.material)];
    if (!material.emissive()) continue;
    for (uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      const scene::WorldTriangle t = scene::world_triangle(mesh, instance.to_world, k);
      const scene::AreaVector n = scene::area_vector(t);
      const Vec3 middle = (t.p0 + t.p1 + t.p2) / 3;
      if (!(n.norm() > 0)) continue;
      const Cell at = cell_of(middle);
      Cluster& cluster = clusters[{at.x, at.y, at.z}];
      // A triangle that is larger than the cube makes its lamp a large one.
      const double area = largest_edge(t) > 1.5f * reach ? INFINITY : 0.5 * n.norm();
      cluster.area += area;
      cluster.weighted += middle * static_cast<float>(0.5 * n.norm());
      cluster.axis +=
          Vec3{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)} * 0.5f;
      cluster.two_sided |= material.double_sided;
    }
  }
  for (const auto& [cube, cluster] : clusters) {
    if (cluster.area > double{reach} * reach) continue;
    const auto scale = static_cast<float>(1 / cluster.area);
    const bool one_way = !cluster.two_sided && length(cluster.axis) * scale > kOneWay;
    add(cluster.weighted * scale, one_way ? normalize(cluster.axis) : Vec3{});
  }
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.kind != scene::LightKind::Directional && max_component(light.intensity) > 0)
      add(light.position, light.kind == scene::LightKind::Spot ? light.direction : Vec3{});
  }
  std::sort(lamps_.begin(), lamps_.end(),
            [](const Lamp& a, const Lamp& b) { return a.key < b.key; });
}

NearLamps::Cell NearLamps::cell_of(const Vec3& position) const {
  const auto on = [&](float x) { return static_cast<int64_t>(std::floor(x / reach_)); };
  return {on(position.x), on(position.y), on(position.z)};
}

uint64_t NearLamps::key_of(const Cell& cell) {
  return mix_bits(static_cast<uint64_t>(cell.x) * 0x9e3779b97f4a7c15ULL ^
                  static_cast<uint64_t>(cell.y) * 0xc2b2ae3d27d4eb4fULL ^
                  static_cast<uint64_t>(cell.z) * 0x165667b19e3779f9ULL);
}

void NearLamps::add(const Vec3& position, const Vec3& axis) {
  marks_.resize(kWords + 1);
  const Cell at = cell_of(position);
  for (int64_t x = -1; x <= 1; ++x) {
    for (int64_t y = -1; y <= 1; ++y) {
      for (int64_t z = -1; z <= 1; ++z) {
        const uint64_t key = key_of({at.x + x, at.y + y, at.z + z});
        lamps_.push_back({position, axis, key});
        marks_[key >> 6 & kWords] |= uint64_t{1} << (key & 63);
      }
    }
  }
}

bool NearLamps::finds_above(const Vec3& position, const Vec3& normal) const {
  const uint64_t key = key_of(cell_of(position));
  auto lamp = std::lower_bound(lamps_.begin(), lamps_.end(), key,
                               [](const Lamp& a, uint64_t b) { return a.key < b; });
  for (; lamp != lamps_.end() && lamp->key == key; ++lamp) {
    const Vec3 to = lamp->position - position;
    if (dot(to, to) < reach_ * reach_ && dot(to, normal) > 0 && dot(to, lamp->axis) <= 0)
      return true;
  }
  return false;
}

}  // namespace lte::gi
