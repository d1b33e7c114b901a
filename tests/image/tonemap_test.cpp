#include "lte/image/tonemap.h"

#include <bit>
#include <cmath>

#include <gmock/gmock.h>

#include "lte/base/random.h"
#include "lte/image/png.h"
#include "lte/image/srgb_byte.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using testing::HasSubstr;

TEST(Image, RefusesEmptySizes) {
  EXPECT_THAT(error_of([] { Image(0, 4, 3); }), HasSubstr("0 x 4"));
  EXPECT_THROW(Image(4, -1, 3), Error);
  EXPECT_THROW(Image(4, 4, 0), Error);
  EXPECT_EQ(Image(4, 3, 2).pixels, std::vector<float>(24));
}

TEST(Srgb, HasTheStandardsValues) {
  // IEC 61966-2-1: 0.5 linear is 187.5 of 255, 0.0031308 is the end of the straight part.
  EXPECT_EQ(linear_to_srgb(0), 0);
  EXPECT_EQ(linear_to_srgb(1), 1);
  EXPECT_NEAR(linear_to_srgb(0.5f), 0.735357, 1e-6);
  EXPECT_NEAR(linear_to_srgb(0.18f), 0.461356, 1e-6);
  EXPECT_NEAR(linear_to_srgb(0.001f), 0.01292, 1e-8);
  EXPECT_NEAR(srgb_to_linear(0.5f), 0.214041, 1e-6);
  EXPECT_EQ(linear_to_srgb(-3), 0);
  EXPECT_EQ(linear_to_srgb(7), 1);
  EXPECT_EQ(linear_to_srgb(NAN), 0);
}

TEST(Srgb, InverseUndoesTheCurveAndBothGrow) {
  float last = -1;
  for (int i = 0; i <= 1000; ++i) {
    const float x = static_cast<float>(i) / 1000;
    EXPECT_NEAR(srgb_to_linear(linear_to_srgb(x)), x, 1e-6);
    EXPECT_GT(linear_to_srgb(x), last);
    last = linear_to_srgb(x);
  }
}

TEST(AutoExposure, BringsThePercentileToTheTarget) {
  Image picture(101, 1, 1);
  for (int x = 0; x < 101; ++x) *picture.at(x, 0) = static_cast<float>(x + 1);  // 1 .. 101
  EXPECT_NEAR(auto_exposure(picture, 0.95f, 0.8f), 0.8 / 96, 1e-6);
  EXPECT_NEAR(auto_exposure(picture, 0, 0.8f), 0.8, 1e-6);
  EXPECT_NEAR(auto_exposure(picture, 1, 0.5f), 0.5 / 101, 1e-6);
}

TEST(AutoExposure, IgnoresBlackAndNonFinitePixelsAndScalesInversely) {
  Image picture = test::random_image(16, 16, 3, 1, 0.1f, 4);
  const float exposure = auto_exposure(picture);
  Image larger(17, 16, 3);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) larger.set_rgb(x, y, picture.rgb(x, y));
    larger.set_rgb(16, y, y % 2 == 0 ? Rgb{0, 0, 0} : Rgb{NAN, INFINITY, 1});
  }
  EXPECT_EQ(auto_exposure(larger), exposure);
  for (float& value : picture.pixels) value *= 1e6f;
  EXPECT_NEAR(auto_exposure(picture), exposure * 1e-6, exposure * 1e-11);
  EXPECT_EQ(auto_exposure(Image(4, 4, 3)), 1);
}

TEST(AutoExposure, MetersSurfacesAndNotTheSkyBehindThem) {
  Image picture(20, 10, 3);  // white sky over a dim surface
  std::vector<uint8_t> surfaces(200);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool sky = y < 5;
      picture.set_rgb(x, y, sky ? Rgb{10, 10, 10} : Rgb{0.02f, 0.02f, 0.02f});
      surfaces[static_cast<size_t>(20 * y + x)] = sky ? 0 : 1;
    }
  }
  EXPECT_NEAR(auto_exposure(picture, 0.95f, 0.8f), 0.08, 1e-6);
  EXPECT_NEAR(auto_exposure(picture, 0.95f, 0.8f, surfaces), 40, 1e-4);
  const std::vector<uint8_t> all(200, 1);
  EXPECT_EQ(auto_exposure(picture, 0.95f, 0.8f, all), auto_exposure(picture, 0.95f, 0.8f));
  std::vector<uint8_t> speck(200);
  speck[199] = 1;  // half a percent: the sky is the picture
  EXPECT_NEAR(auto_exposure(picture, 0.95f, 0.8f, speck), 0.08, 1e-6);
  const std::vector<uint8_t> other(199, 1);
  EXPECT_THROW(auto_exposure(picture, 0.95f, 0.8f, other), Error);
}

TEST(Tonemap, AppliesExposureAndCurve) {
  Image picture(4, 1, 3);
  picture.set_rgb(0, 0, {0.25f, 0, 5});
  picture.set_rgb(1, 0, {NAN, 0, 0});
  picture.set_rgb(2, 0, {0, -INFINITY, 0});
  picture.set_rgb(3, 0, {-1, -2, -3});
  const Image out = tonemap(picture, 2);
  EXPECT_NEAR(out.rgb(0, 0).x, 0.735357, 1e-6);
  EXPECT_EQ(out.rgb(0, 0).y, 0);
  EXPECT_EQ(out.rgb(0, 0).z, 1);
  EXPECT_EQ(out.rgb(1, 0), (Rgb{1, 0, 1}));
  EXPECT_EQ(out.rgb(2, 0), (Rgb{1, 0, 1}));
  EXPECT_EQ(out.rgb(3, 0), (Rgb{0, 0, 0}));
}

TEST(Display, BytesAreThoseOfTheCurve) {
  const auto byte = [](float linear) {
    return static_cast<int>(std::lround(255 * linear_to_srgb(linear)));
  };
  const SrgbBytes& table = srgb_bytes();
  for (const float value : {0.0f, -1.0f, -0.0f, NAN, 1.0f, 2.0f, INFINITY, -INFINITY, 1e-45f})
    EXPECT_EQ(table(value), byte(value)) << value;
  // Floats of all sizes, and every one around the thresholds.
  for (uint32_t bits = 0; bits < 0x3f800000; bits += 1021) {
    const auto value = std::bit_cast<float>(bits);
    ASSERT_EQ(table(value), byte(value)) << value;
  }
  for (int code = 0; code < 255; ++code) {
    const float middle = srgb_to_linear((static_cast<float>(code) + 0.5f) / 255);
    const uint32_t around = std::bit_cast<uint32_t>(middle);
    for (uint32_t bits = around - 500; bits < around + 500; ++bits) {
      const auto value = std::bit_cast<float>(bits);
      ASSERT_EQ(table(value), byte(value)) << value;
    }
  }
}

TEST(Display, IsToneMappingRounded) {
  for (const int channels : {1, 3}) {
    Image picture(31, 37, channels);
    Rng rng(1);
    for (float& value : picture.pixels) value = 2 * rng.uniform() - 0.2f;
    picture.pixels[5] = NAN;
    picture.pixels[40] = INFINITY;
    const Image mapped = tonemap(picture, 0.7f);
    const DisplayPicture shown = display(picture, 0.7f);
    EXPECT_EQ(encode_png(shown), encode_png(mapped));
  }
  EXPECT_THAT(error_of([] { display(Image(1, 1, 2), 1); }), HasSubstr("got 2"));
}

TEST(Tonemap, OneChannelGivesGrey) {
  Image picture(1, 1, 1);
  picture.pixels = {0.5f};
  const Rgb gray = tonemap(picture, 1).rgb(0, 0);
  EXPECT_EQ(gray, (Rgb{gray.x, gray.x, gray.x}));
  EXPECT_NEAR(gray.x, 0.735357, 1e-6);
  EXPECT_THAT(error_of([] { tonemap(Image(1, 1, 2), 1); }), HasSubstr("got 2"));
  EXPECT_THROW(auto_exposure(Image(1, 1, 2)), Error);
}

TEST(HeatMap, RunsThroughItsColors) {
  Image scalar(8, 1, 1);
  scalar.pixels = {0, 1, 2, 3, 4, 99, 0.5f, NAN};
  const Image out = heat_map(scalar, 4);
  EXPECT_EQ(out.rgb(0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(out.rgb(1, 0), (Rgb{0, 0, 1}));
  EXPECT_EQ(out.rgb(2, 0), (Rgb{0, 1, 0}));
  EXPECT_EQ(out.rgb(3, 0), (Rgb{1, 1, 0}));
  EXPECT_EQ(out.rgb(4, 0), (Rgb{1, 0, 0}));
  EXPECT_EQ(out.rgb(5, 0), (Rgb{1, 0, 0}));
  EXPECT_EQ(out.rgb(6, 0), (Rgb{0, 0, 0.5f}));
  EXPECT_EQ(out.rgb(7, 0), (Rgb{1, 0, 1}));
  EXPECT_EQ(heat_map(scalar, 0).rgb(4, 0), (Rgb{0, 0, 0}));
  EXPECT_THROW(heat_map(Image(1, 1, 3), 1), Error);
  EXPECT_THROW(heat_map(scalar, -1), Error);
}

}  // namespace
}  // namespace lte::image
