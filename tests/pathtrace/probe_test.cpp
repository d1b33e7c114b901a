#include "lte/pathtrace/probe.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::pathtrace {
namespace {

using ::testing::HasSubstr;

/// A closed unit cube seen from inside, all of whose faces emit `radiance` and reflect `albedo`.
scene::Scene furnace(float radiance, float albedo) {
  scene::Scene scene;
  const int material = test::add_material(&scene, Rgb{1, 1, 1} * albedo, Rgb{1, 1, 1} * radiance);
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, material, true));
  return scene;
}

/// Irradiance of depths first + 1 to last + 1 everywhere on it: a geometric series.
float furnace_irradiance(float radiance, float albedo, int first, int last) {
  float sum = 0;
  for (int k = first; k <= last; ++k) sum += std::pow(albedo, static_cast<float>(k));
  return kPi * radiance * sum;
}

/// `count` points over the floor of the furnace.
scene::PointTable on_the_floor(int count) {
  scene::PointTable points;
  for (int i = 0; i < count; ++i) {
    points.position.push_back(
        {(static_cast<float>(i) + 0.5f) / static_cast<float>(count), 0, 0.3f});
    points.normal.push_back({0, 1, 0});
    points.lines.push_back("line");
  }
  return points;
}

ProbeResult run(const scene::Scene& scene, const scene::PointTable& points,
                const ProbeOptions& options) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  return probe(bvh, lights, points, options);
}

TEST(Probe, FurnaceGivesTheClosedFormAndHonestErrors) {
  ProbeOptions options;
  options.max_depth = 4;
  options.rays = 256;
  const scene::PointTable points = on_the_floor(64);
  const ProbeResult result = run(furnace(3, 0.6f), points, options);
  const float total = furnace_irradiance(3, 0.6f, 0, 3), direct = furnace_irradiance(3, 0.6f, 0, 0);
  double deviation = 0, variance = 0;
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_NEAR(result.total[i].x, total, 0.1f * total);
    EXPECT_NEAR(result.direct[i].y, direct, 0.1f * direct);
    EXPECT_GE(result.rays[i], 256);
    deviation += std::pow(result.total[i].z - total, 2) / 64;
    variance += std::pow(result.standard_error[i].z, 2) / 64;
  }
  // The mean squared error is what the standard errors say; over 64 points that is known to a
  // factor.
  EXPECT_GT(deviation, 0.4 * variance);
  EXPECT_LT(deviation, 2.5 * variance);
}

TEST(Probe, TargetErrorIsMetWithoutBias) {
  ProbeOptions options;
  options.max_depth = 4;
  options.rays = 1 << 20;
  options.target_error = 0.01;
  const scene::PointTable points = on_the_floor(64);
  const ProbeResult result = run(furnace(3, 0.6f), points, options);
  const double total = furnace_irradiance(3, 0.6f, 0, 3);
  double mean = 0;
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_LT(result.rays[i], 1 << 20);
    EXPECT_NEAR(result.total[i].x, total, 6 * 0.01 * total);
    mean += result.total[i].x / 64;
  }
  EXPECT_LE(result.missed, 16);
  EXPECT_NEAR(mean, total, 5 * 0.01 * total / 8);
}

TEST(Probe, CapIsKeptAndMissesAreCounted) {
  ProbeOptions options;
  options.rays = 128;
  options.target_error = 1e-6;
  const ProbeResult result = run(furnace(3, 0.6f), on_the_floor(10), options);
  EXPECT_EQ(result.missed, 10);
  for (const int64_t rays : result.rays) EXPECT_EQ(rays, 128);
}

TEST(Probe, TighterTargetsTakeMoreRays) {
  ProbeOptions options;
  options.rays = 1 << 20;
  options.target_error = 0.02;
  const scene::PointTable points = on_the_floor(16);
  const scene::Scene scene = furnace(3, 0.6f);
  const ProbeResult loose = run(scene, points, options);
  options.target_error = 0.005;
  const ProbeResult tight = run(scene, points, options);
  int64_t loose_rays = 0, tight_rays = 0;
  for (size_t i = 0; i < 16; ++i) {
    loose_rays += loose.rays[i];
    tight_rays += tight.rays[i];
  }
  EXPECT_GT(tight_rays, 4 * loose_rays);
}

TEST(Probe, OptionsOutOfRangeAreNamed) {
  const auto error_with = [](auto change) {
    ProbeOptions options;
    change(&options);
    return lte::test::error_of([&] { run(furnace(1, 0.5f), on_the_floor(1), options); });
  };
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->rays = 0; }), HasSubstr("--rays"));
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->max_depth = 0; }), HasSubstr("--max-depth"));
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->target_error = -1; }),
              HasSubstr("--target-error"));
}

TEST(Probe, ColumnsAreNamedInTheOrderOfTheirValues) {
  ProbeResult result;
  result.total = {{1.5f, 2, 3}};
  result.direct = {{4, 5, 6}};
  result.standard_error = {{7, 8, 9}};
  result.rays = {256};
  const scene::PointColumns columns = probe_columns(result);
  EXPECT_THAT(columns.names,
              testing::ElementsAre("total_r", "total_g", "total_b", "direct_r", "direct_g",
                                   "direct_b", "stderr_r", "stderr_g", "stderr_b", "rays"));
  ASSERT_EQ(columns.rows.size(), 1u);
  EXPECT_THAT(columns.rows[0], testing::ElementsAre(1.5, 2, 3, 4, 5, 6, 7, 8, 9, 256));
}

}  // namespace
}  // namespace lte::pathtrace
