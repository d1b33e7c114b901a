// Scores of a number of paths between those that were measured.
#include "infer/eval/measure/equal_paths.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lte::infer {
namespace {

/// Errors that fall by a power of the paths, PSNR and SSIM that rise with their logarithm.
ViewScore score_of(double paths) {
  return {8 / paths,
          20 + 10 * std::log10(paths),
          0.5 + 0.1 * std::log(paths),
          4 / std::sqrt(paths),
          0.2 * std::pow(paths, -0.25),
          0.1 * std::pow(paths, -0.25)};
}

TEST(ScoreBetween, FollowsPowersOfThePaths) {
  const std::map<int, ViewScore> measured = {
      {1, score_of(1)}, {4, score_of(4)}, {16, score_of(16)}, {64, score_of(64)}};
  for (const double paths : {1.0, 1.3, 4.0, 10.7, 16.0, 63.0, 64.0}) {
    const std::optional<ViewScore> found = score_between(measured, paths);
    ASSERT_TRUE(found) << paths;
    const ViewScore expected = score_of(paths);
    for (size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR((*found)[k], expected[k], 1e-9 * std::abs(expected[k])) << kViewMetrics[k];
  }
}

TEST(ScoreBetween, SaysNothingBeyondWhatWasMeasured) {
  const std::map<int, ViewScore> measured = {{4, score_of(4)}, {16, score_of(16)}};
  for (const double paths : {0.5, 3.9, 16.1, 300.0})
    EXPECT_FALSE(score_between(measured, paths)) << paths;
  EXPECT_FALSE(score_between({}, 4));
}

TEST(ScoreBetween, TakesAPictureWithoutErrorAsItIs) {
  const std::map<int, ViewScore> measured = {{1, score_of(1)}, {16, ViewScore{}}};
  EXPECT_NEAR(score_between(measured, 4)->at(0), 4, 1e-9) << "half way from 8 to 0";
}

}  // namespace
}  // namespace lte::infer
