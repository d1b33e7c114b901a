#include "lte/image/tone_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lte/image/tonemap.h"

namespace lte::image {
namespace {

Image gray(float value) {
  Image out(1, 1, 3);
  out.set_rgb(0, 0, {value, value, value});
  return out;
}

/// IEC 61966-2-1, in double.
int srgb_byte(double x) {
  x = std::min(1.0, std::max(0.0, x));
  return static_cast<int>(
      std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

TEST(ToneCurve, LinearIsExposureAndSrgb) {
  for (double value = 1e-4; value < 3; value *= 1.07) {
    const int shown = display(gray(static_cast<float>(value)), 0.5f, ToneCurve::Linear).bytes[0];
    EXPECT_NEAR(shown, srgb_byte(0.5 * value), 1) << value;
  }
  EXPECT_EQ(display(gray(-1), 1, ToneCurve::Linear).bytes[0], 0);
}

TEST(ToneCurve, ReinhardKeepsHueAndRollsOff) {
  const Rgb shown = tone_map(ToneCurve::Reinhard, {0.4f, 0.2f, 0.1f});
  EXPECT_NEAR(shown.x / shown.y, 2, 1e-5f);
  const float y = luminance({0.4f, 0.2f, 0.1f});
  EXPECT_NEAR(luminance(shown), y / (1 + y), 1e-6f);
  EXPECT_LE(max_component(tone_map(ToneCurve::Reinhard, {1e6f, 0, 1e6f})), 1);
}

TEST(ToneCurve, EveryCurveRisesFromBlackToWhite) {
  for (const ToneCurve curve : {ToneCurve::Linear, ToneCurve::Reinhard, ToneCurve::Filmic}) {
    EXPECT_NEAR(tone_map(curve, {0, 0, 0}).x, 0, 1e-6f);
    float last = 0;
    for (float value = 0.01f; value < 64; value *= 1.3f) {
      const float shown = tone_map(curve, {value, value, value}).x;
      EXPECT_GE(shown, last);
      EXPECT_LE(shown, 1);
      last = shown;
    }
    EXPECT_GT(last, 0.97f);
  }
}

TEST(ToneCurve, WhatIsNotFiniteIsSeen) {
  const DisplayPicture shown =
      display(gray(std::numeric_limits<float>::quiet_NaN()), 1, ToneCurve::Filmic);
  EXPECT_EQ(shown.bytes, (std::vector<uint8_t>{255, 0, 255}));
}

TEST(ToneCurve, WhatOverflowsIsWhite) {
  for (const ToneCurve curve : {ToneCurve::Linear, ToneCurve::Reinhard, ToneCurve::Filmic})
    EXPECT_EQ(display(gray(1e30f), 1e30f, curve).bytes, (std::vector<uint8_t>{255, 255, 255}));
}

}  // namespace
}  // namespace lte::image
