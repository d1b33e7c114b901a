#include "lte/pathtrace/light_estimates.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/closed_forms.h"
#include "tests/support/light_reference.h"
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
      const double behind = test::polygon_irradiance(two.polygons[g], positions[i], -normals[i]);
      EXPECT_NEAR(light.direct_back[g * 4 + i].x, behind, 0.02 * expected)
          << "group " << g << ", point " << i;
      EXPECT_EQ(light.error[g * 4 + i], 0);
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

std::vector<Rgb> sum_over_groups(const std::vector<Rgb>& values, size_t points) {
  std::vector<Rgb> sums(points);
  for (size_t k = 0; k < values.size(); ++k) sums[k % points] += values[k];
  return sums;
}

/// At each point, direct and indirect light are what many independent paths find on its two sides.
TEST(LightEstimates, AgreeWithManyIndependentPathsPointByPoint) {
  scene::Scene scene = test::furnished_room();
  const Vec3 corner{1.6f, 1.3f, 0.9f};  // a board below the lamps
  test::add_quad(&scene, corner, {1, 0, 0}, {0, 0, 1},
                 test::add_material(&scene, {0.6f, 0.7f, 0.5f}));
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Vec3 on_board = corner + Vec3{0.3f, 0, 0.6f};
  const std::vector<Vec3> positions{on_board,           on_board,        {1.7f, 0, 2.5f},
                                    {0.9f, 1.1f, 0.9f}, {4, 1.2f, 1.5f}, {2.0f, 2.5f, 0.3f}};
  const std::vector<Vec3> normals{{0, 1, 0}, {0, -1, 0}, {0, 1, 0},
                                  {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const size_t count = positions.size();
  constexpr int kPaths = 4096, kDepth = 5;
  const LightEstimates light =
      estimate_light(bvh, lights, positions, normals, std::vector<Rgb>(count), {kPaths, kDepth, 3});
  IrradianceOptions options;
  options.max_depth = kDepth;
  options.rays = kPaths;
  options.seed = 1000;
  const auto own = test::two_sided_light(bvh, lights, positions, normals, options);
  options.rays = 1 << 15;
  options.seed = 2000;
  options.sampling = Sampling::Random;
  const auto reference = test::two_sided_light(bvh, lights, positions, normals, options);
  test::expect_within_error(sum_over_groups(light.direct, count), own.direct, reference.direct,
                            "direct light");
  test::expect_within_error(sum_over_groups(light.indirect, count), own.indirect,
                            reference.indirect, "indirect light");
}

/// A sheet under a lamp, above a black floor: its front has the light of the closed form, and its
/// back none, which is exactly 0.
TEST(LightEstimates, TheBackOfASheetIsNotItsFront) {
  scene::Scene scene;
  const Vec3 corner{-0.5f, 2, -0.5f}, u{1, 0, 0}, v{0, 0, 1};
  test::add_quad(&scene, corner, u, v, test::add_material(&scene, {0, 0, 0}, {1, 1, 1}));
  test::add_quad(&scene, {-3, 1, -3}, {6, 0, 0}, {0, 0, 6},
                 test::add_material(&scene, {0.8f, 0.8f, 0.8f}));
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions(2, {0.2f, 1, 0.1f}), normals{{0, 1, 0}, {0, -1, 0}};
  const LightEstimates light =
      estimate_light(bvh, lights, positions, normals, std::vector<Rgb>(2), {4096, 5, 5});
  const double expected = test::polygon_irradiance({corner, corner + u, corner + u + v, corner + v},
                                                   positions[0], {0, 1, 0});
  EXPECT_NEAR(light.direct[0].x, expected, 0.02 * expected);
  EXPECT_EQ(light.direct_back[0], Rgb{});
  EXPECT_EQ(light.indirect_back[0], Rgb{});
  EXPECT_EQ(light.error_back[0], 0);
  // The normal of the file may look either way.
  EXPECT_NEAR(light.direct_back[1].x, expected, 0.02 * expected);
  EXPECT_EQ(light.direct[1], light.direct_back[1]);
}

/// The standard error that few paths tell of themselves is, on average, how far they are apart from
/// one another under other random numbers.
TEST(LightEstimates, TellHowFarTheyAreOff) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{1.7f, 0, 2.5f}, {2.0f, 2.5f, 0.3f}},
      normals{{0, 1, 0}, {0, -1, 0}};
  constexpr int kRuns = 400;
  const auto G = static_cast<size_t>(lights.groups());
  for (size_t i = 0; i < positions.size(); ++i) {
    const std::span place(&positions[i], 1), normal(&normals[i], 1);
    std::vector<double> sum(G), squares(G), told(G);
    for (uint64_t run = 0; run < kRuns; ++run) {
      const LightEstimates light =
          estimate_light(bvh, lights, place, normal, std::vector<Rgb>(1), {32, 5, run});
      for (size_t g = 0; g < G; ++g) {
        const Rgb front = light.indirect[g] - light.indirect_back[g];
        const double gray = (front.x + front.y + front.z) / 3, error = light.error[g] * gray;
        ASSERT_LE(light.error[g], 1);
        sum[g] += gray;
        squares[g] += gray * gray;
        told[g] += error * error;
      }
    }
    for (size_t g = 0; g < G; ++g) {
      const double mean = sum[g] / kRuns, variance = squares[g] / kRuns - mean * mean;
      ASSERT_GT(variance, 0);
      EXPECT_NEAR(told[g] / kRuns, variance, 0.3 * variance) << "point " << i << ", group " << g;
    }
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
