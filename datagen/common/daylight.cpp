#include "datagen/common/daylight.h"

#include <cmath>

#include "datagen/common/cie_sky.h"
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

Rgb light_tint(float warmth, const Rgb& warmest) {
  const Rgb color = mix(Rgb{0.8f, 0.9f, 1.0f}, warmest, warmth);
  return color / luminance(color);
}

Daylight daylight(const Rgb& radiance, const Vec3& out, Rng* rng) {
  return {radiance, towards_sun(out, rng), 0};
}

void add_sun(Daylight* daylight, Rng* rng, scene::Scene* scene) {
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.kind = scene::LightKind::Directional;
  sun.direction = -daylight->sun;
  const Rgb color = light_tint(rng->uniform(0.3f, 0.9f));
  const float ratio = rng->uniform(1, 6);
  sun.intensity = color * (kPi * luminance(daylight->radiance) * ratio);
  sun.light_group = add_group("sun", scene);
  scene->lights.push_back(sun);
  daylight->sun_on_roof = ratio * daylight->sun.y;
}

void add_sky(const Daylight& daylight, double picture_share, Rng* rng, scene::Scene* scene) {
  scene::Environment sky;
  sky.radiance = daylight.radiance;
  sky.light_group = add_group("sky", scene);
  if (picture_share > 0 && rng->uniform() < picture_share) {
    const CieSky& kind = kCieSkies[rng->below(kCieSkies.size())];
    const Rgb white{1, 1, 1}, blue{0.35f, 0.6f, 1.6f},
        soil = mix({0.3f, 0.2f, 0.12f}, {1, 1, 1}, rng->uniform());
    const Rgb zenith = mix(white, blue, rng->uniform());
    const Rgb horizon = mix(white, zenith, rng->uniform());
    const Rgb ground = soil * (rng->uniform(0.05f, 0.4f) * (1 + daylight.sun_on_roof));
    sky.map = sky_picture(kind, daylight.sun, zenith, horizon, ground);
  }
  scene->environment = sky;
}

}  // namespace lte::datagen
