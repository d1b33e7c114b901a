#include "datagen/common/daylight.h"

#include <cmath>

#include <gtest/gtest.h>

#include "datagen/common/cie_sky.h"

namespace lte::datagen {
namespace {

Vec3 from_angles(double height, double turn) {
  return {static_cast<float>(std::cos(height) * std::cos(turn)),
          static_cast<float>(std::sin(height)),
          static_cast<float>(std::cos(height) * std::sin(turn))};
}

/// What a roof gets from above, of a function of direction.
template <typename Radiance>
double on_roof(const Radiance& radiance) {
  constexpr int kHeights = 400, kTurns = 800;
  double sum = 0;
  for (int i = 0; i < kHeights; ++i) {
    const double height = M_PI / 2 * (i + 0.5) / kHeights;
    for (int k = 0; k < kTurns; ++k)
      sum += radiance(from_angles(height, 2 * M_PI * (k + 0.5) / kTurns)) * std::sin(height) *
             std::cos(height);
  }
  return sum * (M_PI / 2 / kHeights) * (2 * M_PI / kTurns);
}

TEST(CieSky, OvercastIsThatOfMoonAndSpencer) {
  // CIE's first sky stands for theirs, (1 + 2 sin h)/3 of the zenith, which lights a roof with
  // 7/9 π of it.
  const Vec3 sun = from_angles(0.6, 0);
  for (const double height : {0.05, 0.3, 0.8, 1.5})
    EXPECT_NEAR(relative_luminance(kCieSkies[0], from_angles(height, 2), sun),
                (1 + 2 * std::sin(height)) / 3, 0.08)
        << height;
  const double roof =
      on_roof([&](const Vec3& d) { return relative_luminance(kCieSkies[0], d, sun); });
  EXPECT_NEAR(roof, 7 * M_PI / 9, 0.02 * M_PI);
}

TEST(CieSky, UniformIsUniformAndClearIsBrightestAtTheSun) {
  const Vec3 sun = from_angles(0.7, 1);
  EXPECT_DOUBLE_EQ(relative_luminance(kCieSkies[4], from_angles(0.2, 3), sun), 1);
  for (const CieSky& sky : kCieSkies) {
    EXPECT_NEAR(relative_luminance(sky, {0, 1, 0}, sun), 1, 1e-6);
    if (sky.c > 0) {
      EXPECT_GT(relative_luminance(sky, sun, sun),
                relative_luminance(sky, from_angles(0.7, 1 + M_PI), sun));
    }
  }
}

TEST(Lighting, SkiesLightARoofAlike) {
  const Rgb radiance{2, 3, 4};
  int pictures = 0;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    Rng rng(seed);
    scene::Scene scene;
    Daylight light = daylight(radiance, {1, 0, 0}, &rng);
    if (seed % 2 == 0) add_sun(&light, &rng, &scene);
    add_sky(light, 0.5, &rng, &scene);
    ASSERT_TRUE(scene.environment);
    EXPECT_EQ(scene.environment->light_group, static_cast<int>(scene.light_groups.size()) - 1);
    pictures += scene.environment->map != nullptr;
    const double roof =
        on_roof([&](const Vec3& d) { return luminance(scene.environment->radiance_from(d)); });
    // Light of another color than the sky's own weighs the channels otherwise.
    EXPECT_NEAR(roof / (M_PI * luminance(radiance)), 1, scene.environment->map ? 0.1 : 1e-3);
    if (seed % 2 != 0) continue;
    const double sun = luminance(scene.lights.at(0).intensity) * -scene.lights[0].direction.y;
    EXPECT_NEAR(light.sun_on_roof, sun / (M_PI * luminance(radiance)), 1e-5);
  }
  EXPECT_GT(pictures, 2);
  EXPECT_LT(pictures, 10);
}

TEST(Lighting, TheGroundHasTheLightOfSkyAndSun) {
  for (uint64_t seed = 0; seed < 8; ++seed) {
    Rng rng(seed);
    scene::Scene scene;
    Daylight light = daylight({1, 1, 1}, {0, 0, 1}, &rng);
    add_sun(&light, &rng, &scene);
    add_sky(light, 1, &rng, &scene);
    ASSERT_NE(scene.environment->map, nullptr);
    // Of a Lambertian ground: its albedo times the irradiance over π.
    const Rgb below = scene.environment->radiance_from({0, -1, 0});
    const float albedo = luminance(below) / (1 + light.sun_on_roof);
    EXPECT_GT(albedo, 0.01f);
    EXPECT_LT(albedo, 0.41f);
    EXPECT_EQ(below, scene.environment->radiance_from(from_angles(-0.2, 2)));
  }
}

}  // namespace
}  // namespace lte::datagen
