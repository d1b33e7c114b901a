#include "lte/base/to_number.h"

#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace lte {
namespace {

TEST(ToNumber, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(to_number<int>("12"), 12);
  EXPECT_EQ(to_number<int>("-12"), -12);
  EXPECT_EQ(to_number<double>("1.5e3"), 1500);
  for (const char* text : {"", " 12", "12 ", "12x", "x", "+12", "1.5", "0x10", "--1"})
    EXPECT_FALSE(to_number<int>(text)) << text;
}

TEST(ToNumber, TakesNothingThatTheTypeCannotHold) {
  EXPECT_EQ(to_number<int32_t>("2147483647"), 2147483647);
  EXPECT_FALSE(to_number<int32_t>("2147483648"));
  EXPECT_FALSE(to_number<uint64_t>("-1"));
  EXPECT_FALSE(to_number<float>("1e39"));
  EXPECT_TRUE(std::isinf(*to_number<float>("inf"))) << "callers ask for what is finite";
}

TEST(ToNumber, ReadsBehindOnePlus) {
  EXPECT_EQ(to_number<int>(without_plus("+3")), 3);
  EXPECT_EQ(to_number<int>(without_plus("3")), 3);
  EXPECT_FALSE(to_number<int>(without_plus("+")));
  EXPECT_FALSE(to_number<int>(without_plus("++3")));
}

TEST(ToNumbers, TakeTheirCountAndNoOther) {
  EXPECT_EQ((to_numbers<int, 2>("640x480", 'x')), (std::array{640, 480}));
  EXPECT_EQ((to_numbers<float, 3>("1,0.5,-2", ',')), (std::array{1.0f, 0.5f, -2.0f}));
  EXPECT_EQ((to_numbers<int, 1>("7", ',')), (std::array{7}));
  for (const char* text : {"", "640", "640x", "x480", "640x480x", "640x480x1", "640 x480", "6,4"})
    EXPECT_FALSE((to_numbers<int, 2>(text, 'x'))) << text;
}

}  // namespace
}  // namespace lte
