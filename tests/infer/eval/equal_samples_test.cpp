// Errors as path counts, against estimates that really are drawn with that many samples.
#include "infer/eval/measure/equal_samples.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::infer {
namespace {

/// Mean of `count` numbers of variance 1/12.
double mean_of_draws(Rng* rng, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += rng->uniform();
  return sum / count;
}

TEST(EqualSamples, IsThePathCountThatDrewTheEstimates) {
  // A noisy reference of 256 draws; estimates of 64, and of 16 as the predictor.
  constexpr int kPoints = 4000;
  Rng rng(5);
  double mse = 0, path_traced = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double reference = mean_of_draws(&rng, 256);
    mse += std::pow(mean_of_draws(&rng, 16) - reference, 2) / kPoints;
    path_traced += std::pow(mean_of_draws(&rng, 64) - reference, 2) / kPoints;
  }
  const double noise = 1 / (12.0 * 256);
  // Each mean square is known to √(2/4000) = 2.2 %.
  EXPECT_NEAR(equal_samples(mse, path_traced, noise), 16, 0.1 * 16);
  EXPECT_GT(64 * path_traced / mse, 1.1 * 16)
      << "without the noise of the reference it would be off";
}

TEST(EqualSamples, KnowsItsEnds) {
  EXPECT_EQ(equal_samples(0.5, 0.25, 0), 32);
  EXPECT_TRUE(std::isinf(equal_samples(0.1, 0.5, 0.1))) << "no better than the reference is known";
  EXPECT_TRUE(std::isnan(equal_samples(0.1, 0.1, 0.1))) << "path tracing without variance";
  EXPECT_TRUE(std::isnan(equal_samples(NAN, 0.5, 0.1)));
  EXPECT_TRUE(std::isnan(equal_samples(0.1, NAN, 0.1)));
}

TEST(DerivedPathTracing, ScalesVarianceAndKeepsTheReferencesNoise) {
  Score at_64;
  at_64.points = {0.03, 20, 0.5, 0.1};
  at_64.views = {0.05, 30, 0.9, 0.6, 0.1, 0.1};
  const Score at_4 = derived_path_tracing(at_64, {0.01, 0.1}, {0.01, 0.2}, 4);
  EXPECT_NEAR(at_4.points[0], 16 * 0.02 + 0.01, 1e-12);
  EXPECT_NEAR(at_4.points[1], 20 - 10 * std::log10(0.33 / 0.03), 1e-12);
  EXPECT_NEAR(at_4.points[2], 16 * 0.4 + 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(at_4.points[3])) << "no function of the variance";
  EXPECT_NEAR(at_4.views[0], 16 * 0.04 + 0.01, 1e-12);
  EXPECT_NEAR(at_4.views[3], 16 * 0.4 + 0.2, 1e-12);
  for (const size_t metric : {2, 4, 5}) EXPECT_TRUE(std::isnan(at_4.views[metric]));
  EXPECT_NEAR(equal_samples(at_4.views[0], 0.05, 0.01), 4, 1e-9);
  // All of it is noise of the reference: there is nothing to scale.
  EXPECT_EQ(derived_path_tracing(at_64, {0.04, 0.6}, {}, 4).points[0], 0.03);
}

TEST(EqualSamples, OfAllScenesIsThatOfTheMeanErrors) {
  // 8 and 128 samples; the mean errors are (0.8 + 0.1)/2 and (0.1 + 0.2)/2.
  std::vector<Scores> scores(2);
  const double own[] = {0.8, 0.1}, path_traced[] = {0.1, 0.2};
  for (size_t i = 0; i < 2; ++i) {
    Score neural, traced;
    neural.points[0] = own[i];
    traced.points[0] = path_traced[i];
    scores[i] = {{"neural", neural}, {kPathTraced, traced}};
  }
  const std::vector<SceneErrors> scenes = {{scores[0], 0, 0}, {scores[1], 0, 0}};
  const auto samples = all_equal_samples(scenes, Bootstrap(2, {.resamples = 1000}));
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].name, "neural");
  EXPECT_NEAR(samples[0].points.scenes[0], 8, 1e-9);
  EXPECT_NEAR(samples[0].points.scenes[1], 128, 1e-9);
  EXPECT_NEAR(samples[0].points.all, 64 * 0.3 / 0.9, 1e-9);
  EXPECT_NEAR(samples[0].points.median, 68, 1e-9);
  EXPECT_NEAR(samples[0].points.interval.low, 8, 1e-9);
  EXPECT_NEAR(samples[0].points.interval.high, 128, 1e-9);
  EXPECT_TRUE(std::isnan(samples[0].views.all)) << "no views";
  scores[1].pop_back();
  EXPECT_TRUE(all_equal_samples(scenes, Bootstrap(2, {})).empty())
      << "one scene has no path_tracing_64";
}

}  // namespace
}  // namespace lte::infer
