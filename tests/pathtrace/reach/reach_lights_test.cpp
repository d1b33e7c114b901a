// Lights under pruning: none is lost, and the power of each is that of its closed form.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/reach/reach_samples.h"
#include "tests/support/every_light.h"
#include "tests/support/temp_dir.h"

namespace lte::pathtrace {
namespace {

using scene::SurfaceSamples;

/// As scene points are drawn.
SurfaceSamples scene_points(const scene::Scene& scene, int64_t count, uint64_t seed = 0,
                            double emissive_share = 0.1) {
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  sampler.emissive_share = emissive_share;
  PruneCounts counts;
  const Bvh bvh(scene);
  SurfaceSamples samples =
      sample_reached_surface(bvh, count, sampler, Purpose::Scene, {5, seed}, &counts);
  if (count >= 100) {
    EXPECT_GT(counts.pruned, 0) << "else the test tells nothing";
  }
  return samples;
}

/// Area of what is no light, m².
double other_area(const SurfaceSamples& samples) {
  double sum = 0;
  for (size_t i = 0; i < samples.position.size(); ++i)
    if (samples.light_group[i] == scene::kNone) sum += samples.area[i];
  return sum;
}

void expect_no_hidden_points(const SurfaceSamples& samples) {
  for (size_t i = 0; i < samples.position.size(); ++i) {
    const Vec3& p = samples.position[i];
    const bool hidden =
        p.x > 1.1f && p.x < 2.9f && p.y > 0.2f && p.y < 2 && p.z > 0.6f && p.z < 2.4f;
    EXPECT_FALSE(hidden && samples.light_group[i] == scene::kNone);
  }
}

TEST(ReachLights, EveryKindOfLightKeepsItsStrength) {
  for (const test::LitScene& lit : test::scenes_of_every_light()) {
    const SurfaceSamples samples = scene_points(lit.scene, 1000);
    ASSERT_EQ(samples.size(), 1000) << lit.light;
    const std::vector<double> found = test::strengths(samples, lit.strength.size());
    for (size_t g = 0; g < found.size(); ++g)
      EXPECT_NEAR(found[g], lit.strength[g], lit.tolerance * lit.strength[g]) << lit.light;
    EXPECT_NEAR(other_area(samples), test::kReachedArea, 0.03 * test::kReachedArea) << lit.light;
    expect_no_hidden_points(samples);
  }
}

/// The fault was that thinning never kept the last sample, where punctual lights stand.
TEST(ReachLights, PointLightsAreAllThereHoweverMany) {
  for (const int lights : {1, 2, 4, 8, 30}) {
    scene::Scene scene = test::dark_room();
    std::vector<double> strength;
    for (int i = 0; i < lights; ++i) {
      const auto k = static_cast<float>(i);
      test::add_punctual(&scene, scene::LightKind::Point, {1 + k, 1, 1},
                         {0.1f + 0.1f * k, 2.3f, 0.3f});
      strength.push_back(4 * (1 + i));
    }
    for (const int64_t count : {40, 500}) {
      const SurfaceSamples samples = scene_points(scene, count);
      ASSERT_EQ(samples.size(), count);
      const std::vector<double> found = test::strengths(samples, strength.size());
      for (size_t g = 0; g < found.size(); ++g)
        EXPECT_NEAR(found[g], strength[g], 1e-5 * strength[g]) << lights << " lights, " << count;
      // Each stands for as much as any other point, and the surface loses nothing to them.
      EXPECT_NEAR(samples.area.back(), samples.area.front(), 1e-3f * samples.area.front());
      if (count >= 500) {
        EXPECT_NEAR(other_area(samples), test::kReachedArea, 0.05 * test::kReachedArea);
      }
    }
  }
}

TEST(ReachLights, MoreLightsThanPointsAreRefusedByName) {
  scene::Scene scene = test::dark_room();
  for (int i = 0; i < 20; ++i) test::add_point_light(&scene, {0.5f, 2, 0.3f}, {1, 1, 1});
  const Bvh bvh(scene);
  PruneCounts counts;
  EXPECT_THAT(
      test::error_of([&] { sample_reached_surface(bvh, 20, {}, Purpose::Scene, {}, &counts); }),
      ::testing::AllOf(::testing::HasSubstr("20 punctual lights"), ::testing::HasSubstr("room"),
                       ::testing::HasSubstr("more points")));
}

TEST(ReachLights, LuminairesThatWouldTakeMoreThanHalfKeepTheirPower) {
  scene::Scene scene = test::dark_room();
  std::vector<double> strength;
  for (int i = 0; i < 25; ++i) {
    const float x = 0.02f + 0.01f * static_cast<float>(i % 5), z = 0.1f;
    test::add_lamp(&scene, {0.1f + 0.15f * static_cast<float>(i), 2.4f, 0.1f}, x, z, {2, 1, 1});
    strength.push_back(2.0 * static_cast<double>(x) * static_cast<double>(z));
  }
  for (const double share : {0.3, 0.6}) {
    const SurfaceSamples samples = scene_points(scene, 100, 0, share);
    ASSERT_EQ(samples.size(), 100);
    std::map<int, int> points;
    for (const int group : samples.light_group) ++points[group];
    EXPECT_EQ(points.size(), 26u) << "every lamp, and the room";
    EXPECT_GE(points[scene::kNone], 40);
    const std::vector<double> found = test::strengths(samples, strength.size());
    for (size_t g = 0; g < found.size(); ++g)
      EXPECT_NEAR(found[g], strength[g], 1e-5 * strength[g]) << "lamp " << g;
  }
  // Forty points have no room for one of each in their half: all of them together keep their power.
  const std::vector<double> found =
      test::strengths(scene_points(scene, 40, 0, 0.5), strength.size());
  const double all = std::accumulate(strength.begin(), strength.end(), 0.0);
  EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), all, 1e-5 * all);
}

/// Nine hundred lamps and a hundred points: those of the lamps that get one shine for all.
TEST(ReachLights, LuminairesThatAreTooManyToBeMetKeepTheirPowerTogether) {
  scene::Scene scene = test::dark_room();
  constexpr int kSide = 30;
  constexpr double kStrength = 2.0 * 0.02 * 0.03;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float x = 0.1f + 0.12f * static_cast<float>(i % kSide);
    const float z = 0.1f + 0.09f * static_cast<float>(i / kSide);
    test::add_lamp(&scene, {x, 2.4f, z}, 0.02f, 0.03f, {2, 1, 1});
  }
  const SurfaceSamples samples = scene_points(scene, 100);
  const std::vector<double> found = test::strengths(samples, kSide * kSide);
  EXPECT_LT(std::count_if(found.begin(), found.end(), [](double s) { return s > 0; }), 100);
  const double all = kSide * kSide * kStrength;
  EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), all, 1e-3 * all);
}

/// A lamp drawn six times, a quarter of whose points shine, beside ten points of the floor.
TEST(ReachLights, WhatLeavesIsMadeGoodByWhatStays) {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 5}, {4, 0, 0}, gray);
  test::add_lamp(&scene, {0, 2, 0}, 3, 1, {4, 4, 4});
  SurfaceSamples samples;
  KeptSamples kept;
  for (size_t i = 0; i < 16; ++i) {
    const bool lamp = i >= 10;
    samples.position.push_back({static_cast<float>(i), 0, 0});
    samples.normal.push_back({0, 1, 0});
    samples.albedo.push_back({});
    samples.gloss.push_back({});
    samples.emission.push_back(lamp && i % 2 == 0 ? Rgb{4, 2, 1} : Rgb{});
    samples.area.push_back(lamp ? 0.4f : 2.0f);
    samples.light_group.push_back(lamp ? 0 : scene::kNone);
    (lamp ? kept.luminaires : kept.others).push_back(i);
  }
  SurfaceSamples all = samples;
  reduce_samples(scene, kept, 20, &all);
  EXPECT_EQ(all.position, samples.position) << "fewer than asked for: all stay";
  EXPECT_NEAR(test::strengths(all, 1)[0], 4 * 1.5, 1e-5) << "half of the lamp's 3 m²";
  SurfaceSamples few = samples;
  reduce_samples(scene, kept, 8, &few);
  ASSERT_EQ(few.size(), 8);
  EXPECT_EQ(std::count(few.light_group.begin(), few.light_group.end(), 0), 4);
  EXPECT_NEAR(test::strengths(few, 1)[0], 4 * 1.5, 1e-5);
  EXPECT_NEAR(other_area(few), 20, 1e-4);
  EXPECT_TRUE(std::is_sorted(few.light_group.begin(), few.light_group.end()));
}

}  // namespace
}  // namespace lte::pathtrace
