// Lights as scene points: every kind is there, with the strength of a closed form, and a sun is the
// sample that a patch of sky would be.
#include "lte/scene/light_points.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/environment_points.h"
#include "tests/scene/expect.h"
#include "tests/support/every_light.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

SamplerOptions with_luminaires(uint64_t seed = 0) {
  SamplerOptions options;
  options.seed = seed;
  options.emissive_share = 0.1;
  return options;
}

TEST(LightPoints, EveryKindOfLightHasTheStrengthOfItsClosedForm) {
  for (const test::LitScene& lit : test::scenes_of_every_light()) {
    for (const uint64_t seed : {0, 1, 2}) {
      const SurfaceSamples samples = sample_surface(lit.scene, 1000, with_luminaires(seed));
      ASSERT_EQ(samples.size(), 1000) << lit.light;
      const std::vector<double> found = test::strengths(samples, lit.strength.size());
      for (size_t g = 0; g < found.size(); ++g)
        EXPECT_NEAR(found[g], lit.strength[g], lit.tolerance * lit.strength[g]) << lit.light;
    }
  }
}

TEST(LightPoints, ASunIsTheSampleOfAPatchOfSky) {
  using test::expect_near;
  Scene sky = test::dark_room();
  test::add_sky(&sky, {1, 1, 1});
  const size_t cell = 967;  // of 50 cells from 950 on
  const Vec3 along = sample_surface(sky, 1000, {}).normal[cell];
  image::Image picture(512, 256, 3);
  const EnvironmentMap grid(picture, SphereMapping::Equirectangular);
  const auto texel = static_cast<int>(grid.index(-along));
  picture.set_rgb(texel % 512, texel / 512, {9000, 6000, 3000});
  sky.environment->map =
      std::make_shared<const EnvironmentMap>(picture, SphereMapping::Equirectangular);
  const auto solid_angle = static_cast<float>(grid.solid_angle(texel / 512));
  Scene sunny = test::dark_room();
  PunctualLight& sun =
      test::add_punctual(&sunny, LightKind::Directional, Rgb{9000, 6000, 3000} * solid_angle);
  sun.direction = along;

  const SurfaceSamples of_sky = sample_surface(sky, 1000, {}),
                       of_sun = sample_surface(sunny, 1000, {});
  for (size_t i = 950; i < 1000; ++i)
    EXPECT_EQ(max_component(of_sky.emission[i]) > 0, i == cell) << "the patch is one cell's";
  expect_near(of_sun.position[999], of_sky.position[cell]);
  expect_near(of_sun.normal[999], of_sky.normal[cell]);
  expect_near(of_sun.emission[999] / of_sky.emission[cell].x,
              of_sky.emission[cell] / of_sky.emission[cell].x, 1e-3f);
  EXPECT_NEAR(of_sun.area[999], of_sky.area[cell], 1e-5);
  EXPECT_EQ(of_sun.albedo[999], Rgb{});
  EXPECT_EQ(of_sun.light_group[999], 0);
}

TEST(LightPoints, ASunGivesItsIrradianceWhateverTheNumberOfPoints) {
  Scene scene = test::dark_room();
  test::add_punctual(&scene, LightKind::Directional, {5, 4, 3});
  test::add_punctual(&scene, LightKind::Directional, {0, 0, 0});  // black: no point
  const EnvironmentSphere sphere = environment_sphere(scene);
  for (const int64_t count : {2, 64, 4096}) {
    const SurfaceSamples samples = sample_surface(scene, count, with_luminaires());
    ASSERT_EQ(samples.size(), count);
    std::set<int> groups(samples.light_group.begin(), samples.light_group.end());
    EXPECT_EQ(groups, (std::set<int>{kNone, 0}));
    const size_t i = samples.position.size() - 1;
    const Vec3 away = samples.position[i] - sphere.center;
    EXPECT_NEAR(length(away), sphere.radius, 1e-5);
    EXPECT_NEAR(dot(away, scene.lights[0].direction), -sphere.radius, 1e-5);
    // L A cos / r² on what faces it.
    EXPECT_NEAR(samples.emission[i].y * samples.area[i] / (sphere.radius * sphere.radius), 4, 1e-4);
  }
  Bounds expected = scene.bounds();
  expected.extend(sphere.center - scene.lights[0].direction * sphere.radius);
  EXPECT_EQ(point_bounds(scene).low, expected.low);
  EXPECT_EQ(point_bounds(scene).high, expected.high);
  EXPECT_GT(point_bounds(scene).high.y, scene.bounds().high.y) << "it stands outside";
}

TEST(LightPoints, NoLuminaireIsMissedBesideOthersAHundredThousandTimesItsSize) {
  Scene scene = test::dark_room();
  test::add_lamp(&scene, {0.5f, 2.4f, 0.2f}, 3, 2, {1, 1, 1});
  for (int i = 0; i < 20; ++i)
    test::add_lamp(&scene, {0.1f + 0.1f * static_cast<float>(i), 2.45f, 2.8f}, 0.005f, 0.01f,
                   {9, 9, 9});
  for (const int64_t count : {64, 1000}) {
    const SurfaceSamples samples = sample_surface(scene, count, with_luminaires(3));
    ASSERT_EQ(samples.size(), count);
    const std::vector<double> found = test::strengths(samples, 21);
    EXPECT_NEAR(found[0], 6, count == 64 ? 2.3 : 0.01) << "to within a stratum";
    for (size_t g = 1; g < 21; ++g) EXPECT_NEAR(found[g], 9 * 5e-5, 1e-8) << "lamp " << g;
    double area = 0;
    for (const float a : samples.area) area += a;
    EXPECT_NEAR(area, test::kReachedArea + test::kHiddenArea + 6 + 20 * 5e-5, 0.01);
  }
  // Thirty points cannot hold twenty lamps and more of the room than of them: chance decides.
  EXPECT_EQ(sample_surface(scene, 30, with_luminaires()).size(), 30);
}

TEST(LightPoints, LightsThatLeaveNoSurfaceAreRefused) {
  Scene scene = test::dark_room();
  for (int i = 0; i < 12; ++i) test::add_point_light(&scene, {2, 2.3f, 1}, {1, 1, 1});
  test::add_punctual(&scene, LightKind::Directional, {1, 1, 1});
  EXPECT_EQ(sample_surface(scene, 14, {}).size(), 14);
  EXPECT_THAT(test::error_of([&] { sample_surface(scene, 13, {}); }),
              ::testing::AllOf(::testing::HasSubstr("13 punctual lights"),
                               ::testing::HasSubstr("more points")));
}

}  // namespace
}  // namespace lte::scene
