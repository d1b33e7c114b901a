// Ticks of axes: inside, round, and always some.
#include "experiments/ticks.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/chart.h"

namespace lte::experiments {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Ticks, OfALinearAxisAreRound) {
  EXPECT_THAT(linear_ticks(0, 10), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(linear_ticks(-1.5, 3.2), ElementsAre(-1, 0, 1, 2, 3));
  EXPECT_LE(linear_ticks(1e17, 1e17 + 32).size(), 12u) << "ends where steps vanish by rounding";
}

TEST(Ticks, OfALogarithmicAxisAreWholeDecadesWhereThereAreEnough) {
  EXPECT_THAT(log_ticks(1, 100), ElementsAre(1, 10, 100));
  EXPECT_EQ(log_ticks(1e-20, 1e20).size(), 9u) << "every fifth of forty decades";
}

TEST(Ticks, OfADecadeAreOneTwoFive) {
  EXPECT_THAT(log_ticks(0.9, 8), ElementsAre(DoubleEq(1), DoubleEq(2), DoubleEq(5)));
  EXPECT_THAT(log_ticks(3, 30), ElementsAre(DoubleEq(5), DoubleEq(10), DoubleEq(20)));
}

TEST(Ticks, OfLessThanADecadeAreLinear) {
  EXPECT_THAT(log_ticks(0.31, 0.34),
              ElementsAre(DoubleEq(0.31), DoubleEq(0.32), DoubleEq(0.33), DoubleEq(0.34)));
}

TEST(Ticks, AreThereAndInsideForEveryLogarithmicAxis) {
  for (double low = 1.03e-7; low < 1e6; low *= 3.7) {
    for (double ratio = 1.001; ratio < 1e12; ratio *= 1.9) {
      const std::vector<double> found = log_ticks(low, low * ratio);
      EXPECT_GE(found.size(), 2u) << low << " times " << ratio;
      EXPECT_LE(found.size(), 12u) << low << " times " << ratio;
      for (const double value : found) {
        EXPECT_GE(value, low * (1 - 1e-6));
        EXPECT_LE(value, low * ratio * (1 + 1e-6));
      }
    }
  }
}

TEST(Ticks, StandOnAChartOfALossThatMovesLittle) {
  const std::string chart =
      html_chart({.title = "loss", .log_y = true}, {{"", {{0, 0.34}, {9, 0.31}}}});
  EXPECT_THAT(chart, HasSubstr(">0.32</text>"));
}

}  // namespace
}  // namespace lte::experiments
