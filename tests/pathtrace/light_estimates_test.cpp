#include "lte/pathtrace/light_estimates.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

/// Two rectangles of one unit of radiance each, two light groups; nothing else is in the way.
struct TwoLights {
  scene::Scene scene;
  std::vector<std::vector<Vec3>> polygons;

  TwoLights() {
    for (const float x : {-2.0f, 1.0f}) {
      const Vec3 corner{x, 2, -0.5f}, u{1, 0, 0}, v{0, 0, 1};
      test::add_quad(&scene, corner, u, v, test::add_material(&scene, {0, 0, 0}, {1, 1, 1}));
      polygons.push_back({corner, corner + u, corner + u + v, corner + v});
    }
  }
};

TEST(LightEstimates, BothSidesOfASurfaceCountByLightGroup) {
  const TwoLights two;
  const Bvh bvh(two.scene);
  const Lights lights(two.scene);
  ASSERT_EQ(lights.groups(), 2);
  const std::vector<Vec3> positions(4, {0.2f, 0, 0.1f});
  // Up, down (the file's normal may look away from the light), sideways, and a luminaire.
  const std::vector<Vec3> normals{{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Rgb> emission{{}, {}, {}, {0, 3, 0}};
  const LightEstimates light =
      estimate_light(bvh, lights, positions, normals, emission, {4096, 5, 5});
  ASSERT_EQ(light.direct.size(), 8u);
  ASSERT_EQ(light.indirect.size(), 8u);
  for (size_t g = 0; g < 2; ++g) {
    for (size_t i = 0; i < 3; ++i) {
      const double expected = test::polygon_irradiance(two.polygons[g], positions[i], normals[i]) +
                              test::polygon_irradiance(two.polygons[g], positions[i], -normals[i]);
      ASSERT_GT(expected, 0.01);
      EXPECT_NEAR(light.direct[g * 4 + i].x, expected, 0.02 * expected)
          << "group " << g << ", point " << i;
      EXPECT_EQ(light.indirect[g * 4 + i], Rgb{});  // black luminaires reflect nothing
    }
    EXPECT_EQ(light.direct[g * 4 + 3], Rgb{});
  }
}

/// In a closed body of one albedo and one emission, every later bounce is ρ times the one before.
TEST(LightEstimates, LaterBouncesFollowTheFurnace) {
  scene::Scene scene;
  const float albedo = 0.5f;
  test::add_instance(
      &scene,
      test::box_mesh({0, 0, 0}, {2, 2, 2},
                     test::add_material(&scene, {albedo, albedo, albedo}, {1, 1, 1}), true));
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions(1, {1, 1, 1}), normals(1, {0, 1, 0});
  for (const int depth : {1, 3}) {
    const LightEstimates light =
        estimate_light(bvh, lights, positions, normals, {{Rgb{}}}, {4096, depth, 1});
    double direct = 0, indirect = 0;
    for (int64_t g = 0; g < lights.groups(); ++g) {
      direct += light.direct[static_cast<size_t>(g)].x;
      indirect += light.indirect[static_cast<size_t>(g)].x;
    }
    EXPECT_NEAR(direct, 2 * kPi, 0.02 * 2 * kPi);
    const double later = depth == 1 ? 0 : 2 * kPi * (albedo + albedo * albedo);
    EXPECT_NEAR(indirect, later, 0.02 * later);
  }
}

TEST(LightEstimates, TakeNoneAndRefuseArraysOfDifferentLength) {
  const TwoLights two;
  const Bvh bvh(two.scene);
  const Lights lights(two.scene);
  EXPECT_TRUE(estimate_light(bvh, lights, {}, {}, {}, {32, 5, 1}).direct.empty());
  const std::vector<Vec3> one{{0, 0, 0}};
  EXPECT_THROW(estimate_light(bvh, lights, one, one, {}, {32, 5, 1}), Error);
}

}  // namespace
}  // namespace lte::pathtrace
