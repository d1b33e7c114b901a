#include "lte/pathtrace/lights/punctual_lights.h"

#include <algorithm>
#include <cmath>

namespace lte::pathtrace {
namespace {

/// The windowing and inverse square law of KHR_lights_punctual.
float range_window(float distance, float range) {
  if (!std::isfinite(range)) return 1;
  const float ratio = distance / range;
  return std::clamp(1 - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
}

float spot_factor(const scene::PunctualLight& light, const Vec3& direction_to_light) {
  const float cos_outer = std::cos(light.outer_cone);
  const float width = std::max(0.001f, std::cos(light.inner_cone) - cos_outer);
  const float cos_angle = -dot(light.direction, direction_to_light);
  const float factor = std::clamp((cos_angle - cos_outer) / width, 0.0f, 1.0f);
  return factor * factor;
}

}  // namespace

double punctual_power(const scene::PunctualLight& light, const Bounds& bounds) {
  const double intensity = luminance(light.intensity);
  switch (light.kind) {
    case scene::LightKind::Point:
      return 4 * kPi * intensity;
    case scene::LightKind::Spot:
      return 2 * kPi * intensity * (1 - std::cos(light.outer_cone));
    case scene::LightKind::Directional: {
      const double radius = std::max(length(bounds.extent()) / 2, 1e-3f);
      return kPi * radius * radius * intensity;
    }
  }
  return 0;
}

LightSample sample_punctual(const scene::PunctualLight& light, const Vec3& origin,
                            const Vec3& position) {
  LightSample sample;
  sample.delta = true;
  sample.light_group = light.light_group;
  if (light.kind == scene::LightKind::Directional) {
    sample.direction = -light.direction;
    sample.distance = INFINITY;
    sample.radiance = light.intensity;
    sample.pdf = 1;
    return sample;
  }
  const Vec3 offset = light.position - origin - position;
  const float distance2 = dot(offset, offset);
  if (!(distance2 > 0)) return sample;
  sample.distance = std::sqrt(distance2);
  sample.direction = offset / sample.distance;
  float factor = range_window(sample.distance, light.range) / distance2;
  if (light.kind == scene::LightKind::Spot) factor *= spot_factor(light, sample.direction);
  if (!(factor > 0) || !std::isfinite(factor)) return sample;
  sample.radiance = light.intensity * factor;
  sample.pdf = 1;
  return sample;
}

}  // namespace lte::pathtrace
