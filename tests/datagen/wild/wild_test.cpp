// Whole wild scenes: what they are made of, over many seeds.
#include "datagen/wild/wild.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/bake/bake.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/light_points.h"
#include "lte/scene/luminaire_power.h"
#include "tests/datagen/scenes.h"
#include "tests/datagen/wild/quick.h"

namespace lte::datagen::wild {
namespace {

/// Two hundred scenes, made once.
const std::vector<Wild>& scenes() {
  static const std::vector<Wild> made = [] {
    std::vector<Wild> all;
    for (uint64_t seed = 0; seed < 200; ++seed) all.push_back(generate_wild(quick(), seed));
    return all;
  }();
  return made;
}

TEST(Wild, EveryKindOfPlanCeilingOpeningAndLampAppears) {
  std::map<PlanKind, int> plans;
  std::map<CeilingKind, int> ceilings;
  std::map<OpeningKind, int> openings;
  std::map<LampKind, int> lamps;
  std::map<int, int> cells;
  for (const Wild& wild : scenes()) {
    ++plans[wild.plan.plan.kind];
    ++cells[static_cast<int>(wild.plan.plan.cells.size())];
    for (const LampKind kind : wild.plan.lamps) ++lamps[kind];
    for (const Cell& cell : wild.plan.plan.cells) {
      ++ceilings[cell.ceiling.kind];
      for (const std::vector<Hole>& holes : cell.holes)
        for (const Hole& hole : holes) ++openings[hole.kind];
    }
  }
  EXPECT_EQ(plans.size(), static_cast<size_t>(kPlanKinds));
  EXPECT_EQ(ceilings.size(), static_cast<size_t>(kCeilingKinds));
  EXPECT_EQ(openings.size(), static_cast<size_t>(kOpeningKinds));
  EXPECT_EQ(lamps.size(), static_cast<size_t>(kLampKinds));
  EXPECT_EQ(cells.size(), 5u);
}

TEST(Wild, NumbersAreWithinTheirBounds) {
  float smallest = INFINITY, largest = 0;
  size_t most_lamps = 0, skies = 0;
  for (const Wild& wild : scenes()) {
    const scene::Scene& scene = wild.scene;
    const Vec3 size = scene::point_bounds(scene).extent();
    smallest = std::min(smallest, max_component(scene.bounds().extent()));
    largest = std::max(largest, max_component(size));
    EXPECT_LE(max_component(size), 15.51f);
    EXPECT_LE(scene.triangle_count(), kMaxTriangles);
    EXPECT_GE(scene.light_groups.size(), 1u);
    EXPECT_LE(scene.light_groups.size(), kMaxGroups + 2u);
    EXPECT_FALSE(scene.cameras.empty());
    EXPECT_LE(scene.cameras.size(), wild.plan.plan.cells.size());
    most_lamps = std::max(most_lamps, wild.plan.lamps.size());
    EXPECT_EQ(wild.plan.sky, scene.environment.has_value());
    skies += wild.plan.sky ? 1 : 0;
    for (const scene::Mesh& mesh : scene.meshes)
      for (const Vec3& p : mesh.positions) ASSERT_TRUE(is_finite(p)) << mesh.name;
    for (const Rgb& power : scene::luminaire_powers(scene)) EXPECT_TRUE(is_finite(power));
  }
  EXPECT_LT(smallest, 2);
  EXPECT_GT(largest, 13);
  EXPECT_GT(most_lamps, 20u);
  EXPECT_LE(most_lamps, 40u);
  EXPECT_GT(skies, 20u);
}

TEST(Wild, AlbedosReachFromDarkToBrightAndSaturated) {
  float low = 1, high = 0;
  int plain = 0, textured = 0, saturated = 0;
  for (const Wild& wild : scenes()) {
    for (const scene::Material& m : wild.scene.materials) {
      if (m.name != "shell") continue;
      ++(m.base_color_texture.texture == scene::kNone ? plain : textured);
      if (m.base_color_texture.texture != scene::kNone) continue;
      const Rgb& c = m.base_color;
      low = std::min({low, c.x, c.y, c.z});
      high = std::max(high, max_component(c));
      if (std::min({c.x, c.y, c.z}) < 0.4f * max_component(c)) ++saturated;
    }
  }
  EXPECT_GE(low, 0.02f);
  EXPECT_LT(low, 0.03f);
  EXPECT_GT(high, 0.95f);
  EXPECT_LE(high, 0.97f);
  EXPECT_GT(textured, plain / 3);
  EXPECT_GT(saturated, plain / 12);
}

TEST(Wild, LampsShineFromOneSideOrBothAndHavePower) {
  int one = 0, both = 0, lit = 0;
  for (const Wild& wild : scenes()) {
    for (const scene::Instance& instance : wild.scene.instances) {
      const scene::Mesh& mesh = wild.scene.meshes[static_cast<size_t>(instance.mesh)];
      const scene::Material& m = wild.scene.materials[static_cast<size_t>(mesh.material)];
      EXPECT_EQ(m.emissive(), instance.light_group != scene::kNone);
      if (m.emissive()) ++(m.double_sided ? both : one);
    }
    float sum = 0;
    for (const Rgb& power : scene::luminaire_powers(wild.scene)) sum += luminance(power);
    EXPECT_EQ(sum > 0, !wild.plan.lamps.empty());
    if (sum > 0) ++lit;
  }
  EXPECT_GT(both, one / 10);
  EXPECT_LT(both, one);
  EXPECT_GT(lit, 150);
}

TEST(Wild, OneSeedGivesOneScene) {
  std::map<std::string, uint64_t> seen;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const scene::Scene again = generate_wild(quick(), seed).scene;
    const std::string geometry = scene::fingerprint(again).geometry;
    EXPECT_EQ(geometry, scene::fingerprint(scenes()[seed].scene).geometry) << seed;
    EXPECT_TRUE(seen.emplace(geometry, seed).second) << seed << " is " << seen[geometry];
  }
}

TEST(Wild, ClosedScenesLoseNoRay) {
  int closed = 0;
  for (const Wild& wild : scenes()) {
    if (!wild.plan.closed || ++closed > 40) continue;
    const pathtrace::Bvh bvh(wild.scene);
    Rng rng(1);
    for (const scene::Camera& camera : wild.scene.cameras) {
      for (int i = 0; i < 200; ++i) {
        const float y = rng.uniform(-1, 1), a = rng.uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
        const pathtrace::Ray ray{camera.origin, {r * std::cos(a), y, r * std::sin(a)}};
        ASSERT_TRUE(bvh.intersect(ray).valid()) << wild.scene.name;
      }
    }
  }
  EXPECT_GT(closed, 30);
}

TEST(Wild, ABakedSceneIsFiniteAndLit) {
  const scene::Scene& scene = scenes()[3].scene;
  BakeOptions options = test::tiny_bake();
  options.prune = true;
  options.view_cameras = scene.cameras;
  const data::SceneSample sample = bake_scene(scene, options, false);
  EXPECT_EQ(sample.scene_points(), options.scene_points);
  float sum = 0;
  for (const std::vector<Rgb>* values : {&sample.direct, &sample.indirect}) {
    for (const Rgb& value : *values) {
      ASSERT_TRUE(is_finite(value));
      sum += luminance(value);
    }
  }
  EXPECT_GT(sum, 0);
  ASSERT_EQ(sample.views.size(), 1u);
  EXPECT_GT(std::count(sample.views[0].mask.begin(), sample.views[0].mask.end(), 1), 24);
}

TEST(Wild, RangesOfOneGiveRoomsOfOneCellAndLampsOfOne) {
  WildConfig config = quick();
  config.cells = {1, 1};
  config.lamps = {1, 1};
  config.sky_share = 0;
  config.extent_m = {4, 4};
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Wild wild = generate_wild(config, seed);
    EXPECT_EQ(wild.plan.plan.cells.size(), 1u);
    EXPECT_EQ(wild.plan.lamps.size(), 1u);
    EXPECT_NEAR(max_component(wild.scene.bounds().extent()), 4, 1e-3f);
  }
}

}  // namespace
}  // namespace lte::datagen::wild
