// Rooms that keep their surfaces and light, and figures of known changes.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/stability/stability.h"
#include "experiments/stability/stability_report.h"
#include "experiments/stability/stress_scene.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {

namespace {

using testing::HasSubstr;

// Floor, ceiling and walls; four boxes without their bottoms; the lamp.
constexpr double kRoomArea = 2 * (6 * 4 + 6 * 2.7 + 4 * 2.7);
constexpr double kBoxes = 0.9 * 0.6 + 2 * 1.9 * (0.9 + 0.6) + 1.5 * 0.9 + 2 * 0.75 * (1.5 + 0.9) +
                          1.2 * 1.1 + 2 * 1.2 * (1.2 + 1.1) + 1.2 * 0.8 + 2 * 0.45 * (1.2 + 0.8);
constexpr double kLamp = 0.8 * 0.6;
constexpr double kArea = kRoomArea + kBoxes + kLamp;

TEST(StressRoom, KeepsItsAreaWhateverItIsCutInto) {
  EXPECT_NEAR(scene::surface_area(make_stress_room({})), kArea, 1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.triangles = 20'000})), kArea, 1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.degenerate = true})), kArea, 1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.slivers = true})), kArea, 1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.luminaires = 1000})), kArea, 1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.coincident = true})), 2 * kArea - kLamp,
              1e-4 * kArea);
  EXPECT_NEAR(scene::surface_area(make_stress_room({.scale = 100})), 1e4 * kArea, kArea);
}

TEST(StressRoom, HasTheTrianglesAndLightsAskedFor) {
  EXPECT_EQ(make_stress_room({}).triangle_count(), 2 * (6 + 4 * 5 + 1));
  const auto fine = static_cast<double>(make_stress_room({.triangles = 100'000}).triangle_count());
  EXPECT_NEAR(fine, 100'000, 2'000);
  const scene::Scene many = make_stress_room({.luminaires = 1000});
  EXPECT_EQ(many.light_groups.size(), 1000u);
  EXPECT_EQ(many.instances.back().light_group, 999);
  const Bounds bounds = make_stress_room({.scale = 2, .offset = {10, 0, 0}}).bounds();
  EXPECT_FLOAT_EQ(bounds.low.x, 10);
  EXPECT_FLOAT_EQ(bounds.high.x, 22);
}

TEST(Stability, ComparesAnswersOverTheMeanOfTheBase) {
  const std::vector<Rgb> base = {{1, 1, 1}, {3, 3, 3}}, answers = {{2, 2, 2}, {7, 6, 5}};
  const Change same = compare(answers, answers);
  EXPECT_EQ(same.mean, 0);
  EXPECT_EQ(same.most, 0);
  const Change change = compare(answers, base, 2);  // differences 0 0 0 0.5 0 -0.5 over 2
  EXPECT_DOUBLE_EQ(change.mean, 1.0 / 12);
  EXPECT_DOUBLE_EQ(change.most, 0.25);
  EXPECT_DOUBLE_EQ(change.shift, 0);
  EXPECT_TRUE(change.keeps({Figure::Max, 0.25}));
  EXPECT_FALSE(change.keeps({Figure::Max, 0.24}));
  EXPECT_TRUE(change.keeps({}));
}

TEST(Stability, AnAnswerThatIsNotFiniteBreaksEveryBound) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Change change = compare(std::vector<Rgb>{{1, nan, INFINITY}}, std::vector<Rgb>{{1, 1, 1}});
  EXPECT_EQ(change.non_finite, 2);
  EXPECT_EQ(change.most, 0);
  EXPECT_FALSE(change.keeps({}));
  const StabilityRow row{"surfaces", "slivers", "paths", "none", change, {}};
  EXPECT_FALSE(all_hold({row}));
  EXPECT_THAT(stability_verdict({row}), HasSubstr("surfaces, slivers (paths): 2 not finite"));
}

}  // namespace
}  // namespace lte::experiments
