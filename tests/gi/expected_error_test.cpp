// Expected squares against the rules that they follow from.
#include "lte/gi/expected_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::gi {
namespace {

double normal(Rng* rng) {
  double sum = -6;  // of twelve uniform numbers
  for (int k = 0; k < 12; ++k) sum += double{rng->uniform()};
  return sum;
}

/// Shifts of kSharedError are drawn and seen with noise: of those that look alike, the mean square.
TEST(ExpectedError, AShiftHasTheSquareOfThoseThatLookLikeIt) {
  Rng rng(5);
  constexpr double kNoise = 0.02;
  for (const double seen : {0.0, 0.05}) {
    double sum = 0, count = 0;
    for (int k = 0; k < 200000; ++k) {
      const double shift = kSharedError * normal(&rng);
      if (std::fabs(shift + kNoise * normal(&rng) - seen) > 0.004) continue;
      sum += shift * shift;
      ++count;
    }
    EXPECT_NEAR(shifted_square(seen, kNoise) / (sum / count), 1, 0.05) << seen;
  }
}

TEST(ExpectedError, DarknessCountsAsATenthOfTheMean) {
  const ErrorUnit unit(3);
  EXPECT_DOUBLE_EQ(unit(0), 0.3);
  EXPECT_DOUBLE_EQ(unit(5), 5.3);
}

}  // namespace
}  // namespace lte::gi
