#include "lte/data/light_groups.h"

#include <gtest/gtest.h>

namespace lte::data {
namespace {

TEST(ErrorOfSum, IndependentErrorsAddInSquares) {
  ErrorOfSum sum;
  EXPECT_EQ(sum.relative(), 0);
  sum.add(0.5f, {6, 6, 6});  // 3
  sum.add(1, {4, 8, 0});     // 4, of the mean over the channels
  EXPECT_FLOAT_EQ(sum.relative(), 5.0f / 10);
  sum.add(0, {30, 0, 0});  // exact
  EXPECT_FLOAT_EQ(sum.relative(), 5.0f / 20);
}

TEST(SumGroups, FrontIsWhatBothSidesHaveBeyondTheBack) {
  const std::vector<Rgb> direct(4, {1, 1, 1}), indirect{{3, 3, 3}, {8, 8, 8}, {5, 5, 5}, {0, 0, 0}},
      back{{3, 3, 3}, {2, 2, 2}, {1, 1, 1}, {0, 0, 0}};
  const std::vector<float> error{0.9f, 0.5f, 0.5f, 0}, error_back{0.5f, 1, 0, 0};
  const PointIrradiance sum = sum_groups({direct, indirect, {}, back, error, error_back}, 2);
  EXPECT_EQ(sum.direct, std::vector<Rgb>(2, {2, 2, 2}));
  EXPECT_EQ(sum.indirect, (std::vector<Rgb>{{8, 8, 8}, {8, 8, 8}}));
  EXPECT_TRUE(sum.direct_back.empty());
  EXPECT_EQ(sum.indirect_back, (std::vector<Rgb>{{4, 4, 4}, {2, 2, 2}}));
  // Point 0: the front has 0 and 4, with errors 0 and 2; the back 3 and 1, with 1.5 and 0.
  // Point 1: the front has 6 and 0, with 3 and 0; the back 2 and 0, with 2 and 0.
  ASSERT_EQ(sum.error.size(), 4u);
  EXPECT_FLOAT_EQ(sum.error[0], 0.5f);
  EXPECT_FLOAT_EQ(sum.error[1], 1.5f / 4);
  EXPECT_FLOAT_EQ(sum.error[2], 0.5f);
  EXPECT_FLOAT_EQ(sum.error[3], 1);
}

}  // namespace
}  // namespace lte::data
