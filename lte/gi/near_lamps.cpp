#include "lte/gi/near_lamps.h"

#include <algorithm>
#include <cmath>

#include "lte/base/random.h"
#include "lte/scene/triangle.h"

namespace lte::gi {
namespace {

/// Of the mean normal of a lamp, above which it shines one way.
constexpr float kOneWay = 0.5f;

}  // namespace

NearLamps::NearLamps(const scene::Scene& scene, float reach) : reach_(reach) {
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const scene::Material& material = scene.materials[static_cast<size_t>(mesh.material)];
    if (!material.emissive()) continue;
    Bounds bounds;
    Vec3 axis;  // area times normal
    double area = 0;
    for (uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      const scene::WorldTriangle t = scene::world_triangle(mesh, instance.to_world, k);
      for (const Vec3& corner : {t.p0, t.p1, t.p2}) bounds.extend(corner);
      const scene::AreaVector n = scene::area_vector(t);
      axis +=
          Vec3{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)} * 0.5f;
      area += 0.5 * n.norm();
    }
    if (!(area > 0) || max_component(bounds.extent()) > reach) continue;
    const bool one_way =
        !material.double_sided && length(axis) > kOneWay * static_cast<float>(area);
    add(bounds.center(), one_way ? normalize(axis) : Vec3{});
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
