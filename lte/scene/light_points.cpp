#include "lte/scene/light_points.h"

#include <algorithm>
#include <cmath>

#include "lte/scene/environment_points.h"
#include "lte/scene/luminaire_power.h"

namespace lte::scene {
namespace {

bool is_sun(const PunctualLight& light) {
  return light.kind == LightKind::Directional && max_component(light.intensity) > 0;
}

Vec3 sun_position(const EnvironmentSphere& sphere, const PunctualLight& sun) {
  return sphere.center - sun.direction * sphere.radius;
}

/// How many of `count` points an environment gets.
int64_t environment_points(int64_t count, double share) {
  return std::max<int64_t>(1, std::llround(static_cast<double>(count) * share));
}

void append(const Vec3& position, const Vec3& normal, const Rgb& emission, float area,
            int light_group, SurfaceSamples* samples) {
  samples->position.push_back(position);
  samples->normal.push_back(normal);
  samples->albedo.push_back({0, 0, 0});
  samples->gloss.push_back({});
  samples->emission.push_back(emission);
  samples->area.push_back(area);
  samples->light_group.push_back(light_group);
}

/// @param discs  of a point light
void append_local_lights(const Scene& scene, float area, int discs, SurfaceSamples* samples) {
  for (const PunctualLight& light : scene.lights) {
    if (light.kind == LightKind::Directional) continue;
    const Rgb emission = punctual_power(light) / (kPi * area);
    if (light.kind == LightKind::Spot) {
      append(light.position, light.direction, emission, area, light.light_group, samples);
      continue;
    }
    for (int disc = 0; disc < discs; ++disc)
      append(light.position, {0, disc == 0 ? -1.0f : 1.0f, 0}, emission / static_cast<float>(discs),
             area, light.light_group, samples);
  }
}

void append_suns(const Scene& scene, double solid_angle, SurfaceSamples* samples) {
  const EnvironmentSphere sphere = environment_sphere(scene);
  const auto omega = static_cast<float>(solid_angle);
  for (const PunctualLight& light : scene.lights) {
    if (!is_sun(light)) continue;
    append(sun_position(sphere, light), light.direction, light.intensity / omega,
           omega * sphere.radius * sphere.radius, light.light_group, samples);
  }
}

}  // namespace

LightPointCounts light_point_counts(const Scene& scene, int64_t count,
                                    const SamplerOptions& options) {
  LightPointCounts counts;
  int64_t bulbs = 0;
  for (const PunctualLight& light : scene.lights) {
    if (!options.punctual_lights) break;
    counts.local += light.kind != LightKind::Directional ? 1 : 0;
    bulbs += light.kind == LightKind::Point ? 1 : 0;
    counts.suns += is_sun(light) ? 1 : 0;
  }
  if (2 * (counts.local + bulbs) <= count) counts.local += bulbs;
  if (scene.environment && options.environment_share > 0)
    counts.environment = environment_points(count, options.environment_share);
  return counts;
}

double sun_solid_angle(int64_t count, const SamplerOptions& options) {
  const double share = options.environment_share > 0 ? options.environment_share
                                                     : SamplerOptions().environment_share;
  return 4 * M_PI / static_cast<double>(environment_points(count, share));
}

void append_light_points(const Scene& scene, int64_t count, float area,
                         const SamplerOptions& options, SurfaceSamples* samples) {
  const LightPointCounts counts = light_point_counts(scene, count, options);
  const int64_t lights = std::count_if(
      scene.lights.begin(), scene.lights.end(),
      [](const PunctualLight& light) { return light.kind != LightKind::Directional; });
  if (counts.local > 0) append_local_lights(scene, area, counts.local > lights ? 2 : 1, samples);
  if (counts.suns > 0) append_suns(scene, sun_solid_angle(count, options), samples);
  append_environment_points(scene, counts.environment, samples);
}

Bounds point_bounds(const Scene& scene) {
  Bounds bounds = scene.bounds();
  if (bounds.empty()) return bounds;
  const EnvironmentSphere sphere = environment_sphere(scene);
  for (const PunctualLight& light : scene.lights)
    if (is_sun(light)) bounds.extend(sun_position(sphere, light));
  if (!scene.environment) return bounds;
  const Vec3 reach{sphere.radius, sphere.radius, sphere.radius};
  bounds.extend(sphere.center - reach);
  bounds.extend(sphere.center + reach);
  return bounds;
}

}  // namespace lte::scene
