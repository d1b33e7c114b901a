#include "datagen/common/lighting.h"

#include <cmath>

#include "datagen/common/raster.h"

namespace lte::datagen {
namespace {

int add_group(const char* name, scene::Scene* scene) {
  scene->light_groups.emplace_back(name);
  return static_cast<int>(scene->light_groups.size()) - 1;
}

Vec3 towards_sun(const Vec3& out, Rng* rng) {
  const auto angle = [&](float low, float high) { return rng->uniform(low, high) * kPi / 180; };
  const Vec3 across{out.z, 0, -out.x};
  const float turn = angle(-60, 60), height = angle(10, 55);
  return normalize((out * std::cos(turn) + across * std::sin(turn)) * std::cos(height) +
                   Vec3{0, std::sin(height), 0});
}

}  // namespace

Rgb light_tint(float warmth) {
  const Rgb color = mix(Rgb{0.8f, 0.9f, 1.0f}, Rgb{1.0f, 0.72f, 0.42f}, warmth);
  return color / luminance(color);
}

void add_sky(const Rgb& radiance, scene::Scene* scene) {
  scene::Environment environment;
  environment.radiance = radiance;
  environment.light_group = add_group("sky", scene);
  scene->environment = environment;
}

void add_sun(const Vec3& out, const Rgb& sky, Rng* rng, scene::Scene* scene) {
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.kind = scene::LightKind::Directional;
  sun.direction = -towards_sun(out, rng);
  const Rgb color = light_tint(rng->uniform(0.3f, 0.9f));
  sun.intensity = color * (kPi * luminance(sky) * rng->uniform(1, 6));
  sun.light_group = add_group("sun", scene);
  scene->lights.push_back(sun);
}

}  // namespace lte::datagen
