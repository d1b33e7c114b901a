// Checked light against closed forms and many paths: wrong light is found, located and measured,
// right light passes.
#include "infer/check/light_check.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/check/check_report.h"
#include "infer/check/checked_regions.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/sampler.h"
#include "tests/infer/fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/room.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

/// The truth at random places of a scene, from so many paths a place.
AnsweredLight traced_light(const test::Room& room, int64_t places, int paths) {
  const scene::SurfaceSamples samples = scene::sample_surface(room.scene, places, {});
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.seed = 1234;
  const pathtrace::Irradiance traced = pathtrace::estimate_irradiance(
      room.bvh, room.lights, samples.position, samples.normal, options);
  AnsweredLight out;
  for (int64_t i = 0; i < traced.points; ++i) {
    const auto at = static_cast<size_t>(i);
    out.add(samples.position[at], samples.normal[at], traced.indirect_sum(i));
  }
  return out;
}

/// Scales what lies at x < `x`.
AnsweredLight scaled_below(AnsweredLight light, float x, float factor) {
  for (size_t i = 0; i < light.size(); ++i) {
    if (light.position[i].x < x) light.irradiance[i] *= factor;
  }
  return light;
}

CheckOptions with_seed(uint64_t seed, int64_t max_paths = int64_t{1} << 13) {
  CheckOptions options;
  options.seed = seed;
  options.max_paths = max_paths;
  return options;
}

/// A lamp of 3 cm in a cup that is open upwards: what lights the room comes by rare paths.
scene::Scene lamp_in_cup() {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.7f, 0.7f, 0.7f});
  const int lamp = test::add_material(&scene, {0.2f, 0.2f, 0.2f}, {900, 900, 900});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  test::add_instance(&scene, test::box_mesh({1.9f, 1, 1.4f}, {2.1f, 1.01f, 1.6f}, white, false));
  for (const float at : {0.0f, 0.19f}) {
    test::add_instance(
        &scene, test::box_mesh({1.9f + at, 1.01f, 1.4f}, {1.91f + at, 1.2f, 1.6f}, white, false));
    test::add_instance(
        &scene, test::box_mesh({1.91f, 1.01f, 1.4f + at}, {2.09f, 1.2f, 1.41f + at}, white, false));
  }
  test::add_instance(&scene,
                     test::box_mesh({1.985f, 1.03f, 1.485f}, {2.015f, 1.06f, 1.515f}, lamp, false));
  return scene;
}

TEST(PlaceTree, CellsPartThePlacesInto64AndHalvesLieApart) {
  Rng rng(3);
  std::vector<Vec3> places(1000);
  for (Vec3& place : places) place = {8 * rng.uniform(), rng.uniform(), 2 * rng.uniform()};
  const PlaceTree tree(places);
  EXPECT_EQ(tree.cells(), 64u);
  std::set<uint32_t> seen;
  size_t rank = 0;
  for (size_t cell = 0; cell < tree.cells(); ++cell) {
    for (const uint32_t place : tree.places(tree.cells() + cell)) {
      seen.insert(place);
      EXPECT_EQ(tree.cell_of_rank(rank++), cell);
    }
  }
  EXPECT_EQ(seen.size(), places.size());
  float left = 0, right = 8;  // the longest axis is cut first
  for (const uint32_t place : tree.places(2)) left = std::max(left, places[place].x);
  for (const uint32_t place : tree.places(3)) right = std::min(right, places[place].x);
  EXPECT_LE(left, right);
  EXPECT_EQ(tree.cells_of(3).first, 32u);
  EXPECT_EQ(tree.cells_of(3).last, 64u);
  for (const size_t count : {size_t{1}, size_t{15}, size_t{16}, size_t{131}}) {
    const PlaceTree small(std::span<const Vec3>{places}.first(count));
    EXPECT_EQ(small.places(1).size(), count);
    EXPECT_GE(small.places(small.cells()).size(), std::min(count, PlaceTree::kMinPlaces));
  }
}

TEST(LightCheck, TakesATenthOfTheRaysThatItChecksWithinBounds) {
  EXPECT_EQ(paths_to_check(0), kMinCheckPaths);
  EXPECT_EQ(paths_to_check(32 * (kMinCheckPaths + 5)), kMinCheckPaths + 5);
  EXPECT_EQ(paths_to_check(int64_t{1} << 40), kMaxCheckPaths);
}

/// Half of the room is off by 30 %: a square of 0.09 there. Elsewhere, and where nothing is wrong,
/// no more is expected than before, as nothing was found.
TEST(LightCheck, ExpectsOfARegionWhatItsPathsHaveFound) {
  const test::Room room;
  const AnsweredLight truth = traced_light(room, 2000, 1024);
  std::vector<float> x;
  for (const Vec3& at : truth.position) x.push_back(at.x);
  std::nth_element(x.begin(), x.begin() + 1000, x.end());
  const LightCheck right = check_light(room.bvh, room.lights, truth, with_seed(3, 1 << 16));
  for (const CheckedRatio& region : right.regions) EXPECT_LT(region.expected_square, 0.004);
  const AnsweredLight half = scaled_below(truth, x[1000], 1.3f);
  const LightCheck wrong = check_light(room.bvh, room.lights, half, with_seed(3, 1 << 16));
  double below = 0, above = 0;
  for (size_t i = 0; i < half.size(); ++i) {
    const CheckedRatio& region = wrong.regions[static_cast<size_t>(wrong.region_of[i])];
    (half.position[i].x < x[1000] ? below : above) += region.expected_square / 1000;
  }
  EXPECT_NEAR(below, 0.09, 0.04);
  EXPECT_LT(above, 0.02);
}

TEST(PlaceTree, ThreeErrorsLeaveThatChanceToAllTestsTogether) {
  for (const size_t tests : {size_t{1}, size_t{5}, size_t{65}}) {
    // Student's density of 31 degrees of freedom beyond it, to both sides.
    double tail = 0;
    const double constant =
        std::exp(std::lgamma(16.0) - std::lgamma(15.5)) / std::sqrt(31 * 3.141592653589793);
    for (double t = three_errors(tests, 32) + 5e-4; t < 60; t += 1e-3)
      tail += 2e-3 * constant * std::pow(1 + t * t / 31, -16);
    EXPECT_NEAR(tail * static_cast<double>(tests), 0.0027, 0.0001) << tests;
  }
}

/// In a closed box of radiance 1 and albedo ρ, light of depth d is π ρ^(d−1).
TEST(LightCheck, AFurnaceHasTheRatioOfItsClosedForm) {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0.6f, 0.6f, 0.6f}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  const test::Room room(std::move(scene));
  const auto truth = static_cast<float>(double{kPi} * (test::geometric_sum(0.6, 6) - 1));
  const scene::SurfaceSamples samples = scene::sample_surface(room.scene, 500, {});
  for (const float factor : {0.7f, 1.0f, 1.3f}) {
    AnsweredLight light;
    for (size_t i = 0; i < samples.position.size(); ++i)
      light.add(samples.position[i], samples.normal[i], Rgb{1, 1, 1} * (factor * truth));
    CheckOptions options = with_seed(5);
    options.max_depth = 6;
    const LightCheck check = check_light(room.bvh, room.lights, light, options);
    EXPECT_NEAR(check.whole.ratio, factor, 4 * check.whole.standard_error + 1e-4);
    EXPECT_LT(check.whole.standard_error, 0.01);
    EXPECT_EQ(check.off(), factor != 1.0f);
    EXPECT_EQ(check_note(check, "the gathered", "the picture").empty(), factor == 1.0f);
  }
}

TEST(LightCheck, StandardErrorsAreTheSpreadOverSeeds) {
  const test::Room room;
  const AnsweredLight light = scaled_below(traced_light(room, 800, 512), 2, 0.9f);
  double sum = 0, squares = 0, variance = 0;
  constexpr int kRuns = 100;
  for (int seed = 0; seed < kRuns; ++seed) {
    const LightCheck check =
        check_light(room.bvh, room.lights, light, with_seed(static_cast<uint64_t>(seed)));
    sum += check.whole.ratio;
    squares += check.whole.ratio * check.whole.ratio;
    variance += check.whole.standard_error * check.whole.standard_error / kRuns;
  }
  const double spread = std::sqrt((squares - sum * sum / kRuns) / (kRuns - 1));
  EXPECT_NEAR(std::sqrt(variance) / spread, 1, 0.25);  // the spread is known to 7 %
}

TEST(LightCheck, LightThatIsHalvedInHalfOfTheRoomIsFoundThere) {
  const test::Room room;
  const AnsweredLight truth = traced_light(room, 1500, 1024);
  const AnsweredLight wrong = scaled_below(truth, 2, 0.5f);
  const LightCheck check = check_light(room.bvh, room.lights, wrong, with_seed(1, 1 << 16));
  EXPECT_TRUE(check.whole.off);
  ASSERT_TRUE(check.fault.has_value());
  EXPECT_NEAR(check.fault->ratio, 0.5, 3 * check.fault->standard_error + 0.02);
  EXPECT_LT(check.fault->centre.x, 2);
  EXPECT_NEAR(check.fault->share, 0.5, 0.1);
  for (const CheckedRatio& region : check.regions) {
    if (region.off) {
      EXPECT_LT(region.centre.x, 2.6f) << "a region of the right half";
    }
    if (region.centre.x > 2.6f) {
      EXPECT_NEAR(region.ratio, 1, 5 * region.standard_error);
    }
  }
  const std::string note = check_note(check, "the network's", "the picture");
  EXPECT_THAT(note, HasSubstr("the network's indirect light is 0."));
  EXPECT_THAT(note, HasSubstr(" % of the picture"));
  EXPECT_EQ(check_note(check_light(room.bvh, room.lights, truth, with_seed(1, 1 << 16)), "", ""),
            "");
}

TEST(LightCheck, AFaultInAnEighthOfTheRoomIsOneOfARegion) {
  const test::Room room;
  const AnsweredLight wrong = scaled_below(traced_light(room, 1500, 1024), 0.5f, 1.6f);
  const LightCheck check = check_light(room.bvh, room.lights, wrong, with_seed(2, 1 << 16));
  ASSERT_TRUE(check.fault.has_value());
  EXPECT_LT(check.fault->centre.x, 0.6f);
  EXPECT_NEAR(check.fault->ratio, 1.6, 0.15);
  EXPECT_LT(check.fault->share, 0.35);
}

TEST(LightCheck, RightLightIsSilentOverSeeds) {
  constexpr uint64_t kSeeds = 100;
  for (const bool cup : {false, true}) {
    const test::Room room(cup ? lamp_in_cup() : test::furnished_room());
    const AnsweredLight light = traced_light(room, 600, 2048);
    int said = 0;
    size_t regions = 0;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      const LightCheck check = check_light(room.bvh, room.lights, light, with_seed(seed));
      said += check.off() ? 1 : 0;
      regions += check.regions.size();
    }
    EXPECT_EQ(said, 0) << "cup " << cup;
    EXPECT_GE(regions, cup ? kSeeds : 4 * kSeeds);
  }
}

TEST(LightCheck, AFewPointsAreComparedAsTheyAre) {
  const test::Room room;
  pathtrace::IrradianceOptions options;
  options.rays = 1 << 14;
  const pathtrace::Irradiance truth = room.estimate(options);
  AnsweredLight light;
  for (size_t i = 0; i < room.positions.size(); ++i)
    light.add(room.positions[i], room.normals[i], truth.indirect_sum(static_cast<int64_t>(i)));
  const LightCheck right = check_light(room.bvh, room.lights, light, with_seed(1));
  EXPECT_FALSE(right.off());
  EXPECT_EQ(right.regions.size(), 1u);
  EXPECT_LT(right.whole.standard_error, 0.03) << "the points are all there are: none is drawn";
  for (Rgb& value : light.irradiance) value *= 0.5f;
  const LightCheck wrong = check_light(room.bvh, room.lights, light, with_seed(1));
  EXPECT_TRUE(wrong.whole.off);
  EXPECT_NEAR(wrong.whole.ratio, 0.5, 4 * wrong.whole.standard_error);
}

TEST(LightCheck, WithoutBouncedLightNothingIsSaid) {
  const test::Room room(test::lit_floor());  // the floor alone reflects
  AnsweredLight light;
  light.add({0.5f, 0, 0}, {0, 1, 0}, {0.01f, 0.01f, 0.01f});
  EXPECT_FALSE(check_light(room.bvh, room.lights, light, with_seed(1)).off());
  EXPECT_FALSE(check_light(room.bvh, room.lights, {}, with_seed(1)).off());
  scene::Scene dark = test::furnished_room();
  for (scene::Material& material : dark.materials) material.emission = {};
  for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
  dark.light_groups.clear();
  const test::Room without(std::move(dark));
  const LightCheck check = check_light(without.bvh, without.lights, light, with_seed(1));
  EXPECT_EQ(check.paths, 0);
  EXPECT_FALSE(check.off());
}

TEST(LightCheck, CountsDecideAndTimeOnlyEnds) {
  const test::Room room;
  const AnsweredLight light = traced_light(room, 600, 256);
  CheckOptions options = with_seed(4, 1 << 15);
  const LightCheck once = check_light(room.bvh, room.lights, light, options),
                   again = check_light(room.bvh, room.lights, light, options);
  EXPECT_EQ(once.whole.ratio, again.whole.ratio);
  EXPECT_EQ(once.whole.standard_error, again.whole.standard_error);
  EXPECT_EQ(once.paths, 1 << 15);
  options.seconds = 0;
  EXPECT_EQ(check_light(room.bvh, room.lights, light, options).paths, 1 << 13);
}

TEST(LightCheck, AnswersThatAreNotFiniteAreRefused) {
  const test::Room room;
  AnsweredLight light;
  light.add({2, 0, 1}, {0, 1, 0}, {INFINITY, 0, 0});
  EXPECT_THROW(check_light(room.bvh, room.lights, light, {}), Error);
  light.irradiance.clear();
  EXPECT_THROW(check_light(room.bvh, room.lights, light, {}), Error);
}

}  // namespace
}  // namespace lte::infer
