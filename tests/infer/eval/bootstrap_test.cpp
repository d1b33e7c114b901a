// Bootstrap intervals against what can be counted or derived by hand.
#include "infer/eval/measure/bootstrap.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

Interval of_mean(const std::vector<double>& values, const BootstrapSettings& settings) {
  return Bootstrap(values.size(), settings).interval([&](std::span<const uint32_t> drawn) {
    double sum = 0;
    for (const uint32_t i : drawn) sum += values[i];
    return sum / static_cast<double>(drawn.size());
  });
}

TEST(Bootstrap, OfTwoScenesHasTheCountedQuantiles) {
  // The mean of two draws from {0, 1} is 0, 1/2, 1 with shares 1/4, 1/2, 1/4.
  const Interval wide = of_mean({0, 1}, {.resamples = 4000, .seed = 3, .level = 0.95});
  EXPECT_EQ(wide.low, 0);
  EXPECT_EQ(wide.high, 1);
  const Interval narrow = of_mean({0, 1}, {.resamples = 4000, .seed = 3, .level = 0.4});
  EXPECT_EQ(narrow.low, 0.5) << "the quantiles 0.3 and 0.7";
  EXPECT_EQ(narrow.high, 0.5);
}

TEST(Bootstrap, OfTheMeanApproachesTheNormalInterval) {
  Rng rng(8);
  std::vector<double> values;
  double mean = 0, square = 0;
  for (int i = 0; i < 400; ++i) {
    values.push_back(rng.uniform() + rng.uniform());
    mean += values.back() / 400;
    square += values.back() * values.back() / 400;
  }
  const double error = std::sqrt((square - mean * mean) / 400);
  const Interval found = of_mean(values, {.resamples = 20'000, .seed = 1, .level = 0.95});
  // 20,000 resamples know a 2.5 % quantile to 1.9 % of the error.
  EXPECT_NEAR(found.low, mean - 1.96 * error, 0.1 * error);
  EXPECT_NEAR(found.high, mean + 1.96 * error, 0.1 * error);
}

TEST(Bootstrap, OfOneSceneHasNoInterval) {
  const Interval found = of_mean({3}, {.resamples = 100});
  EXPECT_TRUE(std::isnan(found.low));
  EXPECT_TRUE(std::isnan(found.high));
}

TEST(Bootstrap, IsTheSameForASeedAndAnotherForAnother) {
  std::vector<double> values;
  for (int i = 0; i < 20; ++i) values.push_back(i * i);
  const Interval a = of_mean(values, {.resamples = 300, .seed = 1});
  const Interval b = of_mean(values, {.resamples = 300, .seed = 1});
  const Interval c = of_mean(values, {.resamples = 300, .seed = 2});
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_NE(a.low, c.low);
}

TEST(Bootstrap, LeavesOutWhatWasNotMeasuredAndKeepsInfinities) {
  std::vector<Scores> scenes(4);
  for (size_t i = 0; i < 4; ++i) {
    Score score;
    score.points[0] = 5;
    if (i > 1) score.views[2] = 3;
    scenes[i].emplace_back("neural", score);
  }
  const Bootstrap bootstrap(4, {.resamples = 500});
  const ScoreIntervals mean = mean_intervals(scenes, bootstrap);
  ASSERT_EQ(mean.size(), 1u);
  EXPECT_EQ(mean[0].second.low.points[0], 5);
  EXPECT_EQ(mean[0].second.high.points[0], 5);
  EXPECT_EQ(mean[0].second.low.views[2], 3);
  EXPECT_TRUE(std::isnan(mean[0].second.low.points[1]));
  EXPECT_EQ(median_intervals(scenes, bootstrap)[0].second.high.views[2], 3);
  const Interval infinite = bootstrap.interval([](std::span<const uint32_t> drawn) {
    return drawn[0] < 2 ? 1.0 : std::numeric_limits<double>::infinity();
  });
  EXPECT_EQ(infinite.low, 1);
  EXPECT_TRUE(std::isinf(infinite.high));
}

TEST(Bootstrap, RefusesSettingsWithoutMeaning) {
  EXPECT_THROW(Bootstrap(0, {}), Error);
  EXPECT_THROW(Bootstrap(3, {.resamples = 0}), Error);
  EXPECT_THROW(Bootstrap(3, {.level = 1}), Error);
}

}  // namespace
}  // namespace lte::infer
