// Half precision against its definition, over all its values.
#include "lte/base/half.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace lte {
namespace {

/// (-1)^sign 2^(exponent - 15) (1 + fraction / 1024), subnormal 2^-14 fraction / 1024.
double by_definition(uint16_t bits) {
  const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
  const double value =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return bits & 0x8000 ? -value : value;
}

TEST(Half, AllFiniteValuesGoThereAndBack) {
  for (uint32_t bits = 0; bits < 0x10000; ++bits) {
    const Half half{static_cast<uint16_t>(bits)};
    if (!is_finite(half)) continue;
    ASSERT_EQ(to_float(half), by_definition(half.bits)) << bits;
    ASSERT_EQ(to_half(to_float(half)), half) << bits;
  }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
  for (uint16_t bits = 0; bits < 0x7bff; ++bits) {
    const double low = by_definition(bits), high = by_definition(static_cast<uint16_t>(bits + 1));
    const auto middle = static_cast<float>((low + high) / 2);  // exact: one bit more
    const uint16_t even = bits % 2 == 0 ? bits : static_cast<uint16_t>(bits + 1);
    ASSERT_EQ(to_half(middle).bits, even) << bits;
    ASSERT_EQ(to_half(std::nextafter(middle, 0.0f)).bits, bits) << bits;
    ASSERT_EQ(to_half(std::nextafter(middle, 1e9f)).bits, bits + 1) << bits;
    ASSERT_EQ(to_half(-middle).bits, even | 0x8000) << bits;
  }
}

TEST(Half, OverflowsToInfinityAndKeepsNan) {
  EXPECT_EQ(to_half(65519.0f).bits, 0x7bff);
  EXPECT_EQ(to_half(65520.0f).bits, 0x7c00);
  EXPECT_EQ(to_half(-1e30f).bits, 0xfc00);
  EXPECT_EQ(to_half(std::numeric_limits<float>::infinity()).bits, 0x7c00);
  EXPECT_FALSE(is_finite(to_half(std::numeric_limits<float>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(to_float(to_half(std::numeric_limits<float>::quiet_NaN()))));
  EXPECT_EQ(to_float(Half{0x7c00}), std::numeric_limits<float>::infinity());
  EXPECT_EQ(to_half(1e-30f).bits, 0);
}

}  // namespace
}  // namespace lte
