#include "datagen/common/sides.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/random.h"

namespace lte::datagen {
namespace {

constexpr uint64_t kSideStream = 0x73696465;
constexpr float kStripShare = 1.0f / 3;
constexpr float kMinStrip = 0.04f, kMaxStrip = 0.12f;  // metres across

Bounds bounds_of(const scene::Mesh& mesh) {
  Bounds bounds;
  for (const Vec3& p : mesh.positions) bounds.extend(p);
  return bounds;
}

/// A flat rectangle that lies as the generators' ceiling lights do.
bool is_panel(const scene::Scene& scene, const scene::Mesh& mesh) {
  if (!scene.materials[mesh.material].emissive() || mesh.positions.empty()) return false;
  const Vec3 extent = bounds_of(mesh).extent();
  return extent.y < 1e-4f && std::min(extent.x, extent.z) > kMaxStrip;
}

/// Brings the shorter side of a panel to `width` metres.
void narrow(float width, scene::Mesh* mesh) {
  const Bounds bounds = bounds_of(*mesh);
  const Vec3 middle = bounds.center(), extent = bounds.extent();
  const int across = extent.x < extent.z ? 0 : 2;
  for (Vec3& p : mesh->positions)
    p[across] = middle[across] + (p[across] - middle[across]) * (width / extent[across]);
}

void hang(const Range& drop, Rng* rng, int mesh_index, scene::Scene* scene) {
  const double by = drop.low * std::pow(drop.high / drop.low, double{rng->uniform()});
  const bool strip = rng->uniform() < kStripShare;
  const float width = rng->uniform(kMinStrip, kMaxStrip);
  scene::Mesh& mesh = scene->meshes[mesh_index];
  if (strip) narrow(width, &mesh);
  scene::Material both = scene->materials[mesh.material];
  both.double_sided = true;
  mesh.material = static_cast<int>(scene->materials.size());
  scene->materials.push_back(std::move(both));
  for (scene::Instance& instance : scene->instances) {
    if (instance.mesh == mesh_index) instance.to_world.m[1][3] -= static_cast<float>(by);
  }
}

}  // namespace

void vary_sides(const SideConfig& config, uint64_t seed, scene::Scene* scene) {
  for (size_t m = 0; m < scene->meshes.size(); ++m) {
    Rng rng(seed, kSideStream + m);
    const float hung = rng.uniform(), flipped = rng.uniform();
    scene::Mesh& mesh = scene->meshes[m];
    if (is_panel(*scene, mesh)) {
      if (hung < config.two_sided_share) hang(config.drop_m, &rng, static_cast<int>(m), scene);
    } else if (!scene->materials[mesh.material].emissive() && flipped < config.flipped_share) {
      for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
  }
}

}  // namespace lte::datagen
