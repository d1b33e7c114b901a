#include "lte/scene/luminaire_power.h"

#include <algorithm>
#include <cmath>

#include "lte/scene/surface.h"

namespace lte::scene {
namespace {

/// π times area times mean radiance. A texture is looked up once a triangle, averaged over its
/// size.
Rgb instance_power(const Scene& scene, int index) {
  const Instance& instance = scene.instances[static_cast<size_t>(index)];
  const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  const bool both = scene.materials[static_cast<size_t>(mesh.material)].double_sided;
  Rgb power;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3 p[3];
    for (size_t k = 0; k < 3; ++k)
      p[k] = instance.to_world.point(mesh.positions[mesh.triangles[t][k]]);
    const float area = 0.5f * length(cross(p[1] - p[0], p[2] - p[0]));
    if (!(area > 0)) continue;
    Rgb albedo, emission;
    evaluate_appearance(scene, index, static_cast<uint32_t>(t), 1.0f / 3, 1.0f / 3, std::sqrt(area),
                        &albedo, &emission);
    power += emission * (kPi * area * (both ? 2.0f : 1.0f));
  }
  return power;
}

}  // namespace

Rgb punctual_power(const PunctualLight& light) {
  if (light.kind == LightKind::Directional) return {};
  if (light.kind == LightKind::Point) return light.intensity * (4 * kPi);
  const float inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  return light.intensity * (2 * kPi * ((1 - inner) + (inner - outer) / 3));
}

std::vector<Rgb> luminaire_powers(const Scene& scene) {
  std::vector<Rgb> powers(scene.light_groups.size());
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const int group = scene.instances[i].light_group;
    if (group != kNone)
      powers[static_cast<size_t>(group)] += instance_power(scene, static_cast<int>(i));
  }
  for (const PunctualLight& light : scene.lights) {
    if (light.light_group != kNone)
      powers[static_cast<size_t>(light.light_group)] += punctual_power(light);
  }
  return powers;
}

float median_power(const std::vector<Rgb>& powers) {
  std::vector<float> shining;
  for (const Rgb& power : powers) {
    if (luminance(power) > 0) shining.push_back(luminance(power));
  }
  if (shining.empty()) return 0;
  const auto middle = shining.begin() + static_cast<ptrdiff_t>(shining.size() / 2);
  std::nth_element(shining.begin(), middle, shining.end());
  return *middle;
}

}  // namespace lte::scene
