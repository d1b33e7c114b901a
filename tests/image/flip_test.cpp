// FLIP against the error maps that its authors' own program gives
// (scripts/validation/check_flip.py), and its laws.
#include "lte/image/flip.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/image/tonemap.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::random_image;
using testing::HasSubstr;

constexpr double kTolerance = 1e-3;

class FlipWitness : public testing::Test {
 protected:
  FlipWitness()
      : json_(nlohmann::json::parse(read_file(LTE_SOURCE_DIR "/tests/image/flip_witness.json"))) {}

  template <typename Transfer>
  Image picture(const char* name, const Transfer& transfer) const {
    Image out(json_.at("width"), json_.at("height"), 3);
    for (size_t i = 0; i < out.pixels.size(); ++i)
      out.pixels[i] = transfer(json_.at(name).at(i).get<float>() / 255);
    return out;
  }

  void expect_same(const Image& error, const nlohmann::json& outside) const {
    ASSERT_EQ(error.pixels.size(), outside.at("map").size());
    for (size_t i = 0; i < error.pixels.size(); ++i)
      EXPECT_NEAR(error.pixels[i], outside.at("map").at(i).get<double>(), kTolerance) << i;
    EXPECT_NEAR(masked_mean(error, {}), outside.at("mean").get<double>(), kTolerance / 10);
  }

  nlohmann::json json_;
};

TEST_F(FlipWitness, IsTheMapOfTheAuthorsProgram) {
  expect_same(flip(picture("test", srgb_to_linear), picture("reference", srgb_to_linear)),
              json_.at("ldr"));
}

TEST_F(FlipWitness, OfHighDynamicRangeIsTheMapOfTheAuthorsProgram) {
  const float scale = json_.at("hdr_scale");
  const auto cubed = [&](float x) { return scale * x * x * x; };
  const Image reference = picture("reference", cubed);
  const FlipExposures exposures = flip_exposures(reference);
  const nlohmann::json& parameters = json_.at("hdr").at("parameters");
  const auto number = [&](const char* name) {
    return std::stod(parameters.at(name).get<std::string>());
  };
  EXPECT_NEAR(exposures.start, number("startExposure"), 1e-4);
  EXPECT_NEAR(exposures.stop, number("stopExposure"), 1e-4);
  EXPECT_EQ(exposures.count, number("numExposures"));
  expect_same(hdr_flip(picture("test", cubed), reference, exposures), json_.at("hdr"));
}

TEST(Flip, IsZeroForEqualPicturesAndOneForGreenAgainstBlue) {
  const Image noise = random_image(21, 13, 3, 1);
  for (const float error : flip(noise, noise).pixels) EXPECT_EQ(error, 0);
  // The pair that the color difference is scaled by; flat pictures have no features.
  Image green(8, 8, 3), blue(8, 8, 3);
  for (int i = 0; i < 64; ++i) {
    green.set_rgb(i % 8, i / 8, {0, 1, 0});
    blue.set_rgb(i % 8, i / 8, {0, 0, 1});
  }
  for (const float error : flip(green, blue).pixels) EXPECT_NEAR(error, 1, 1e-6);
}

TEST(Flip, MirrorsWithItsPictures) {
  const Image a = random_image(19, 11, 3, 2), b = random_image(19, 11, 3, 3);
  const auto mirrored = [](const Image& in) {
    Image out(in.width, in.height, in.channels);
    for (int y = 0; y < in.height; ++y)
      for (int x = 0; x < in.width; ++x)
        std::copy_n(in.at(x, y), in.channels, out.at(in.width - 1 - x, y));
    return out;
  };
  const Image error = flip(a, b), other = mirrored(flip(mirrored(a), mirrored(b)));
  for (size_t i = 0; i < error.pixels.size(); ++i)
    EXPECT_NEAR(error.pixels[i], other.pixels[i], 1e-6);
}

TEST(Flip, OfHighDynamicRangeDoesNotChangeWithTheUnitOfLight) {
  const Image a = random_image(16, 12, 3, 4, 0, 3), b = random_image(16, 12, 3, 5, 0, 3);
  const auto scaled = [](Image image) {
    for (float& value : image.pixels) value *= 64;
    return image;
  };
  const Image before = hdr_flip(a, b, flip_exposures(b));
  const Image after = hdr_flip(scaled(a), scaled(b), flip_exposures(scaled(b)));
  for (size_t i = 0; i < before.pixels.size(); ++i)
    EXPECT_NEAR(before.pixels[i], after.pixels[i], 1e-5);
}

TEST(Flip, StaysFiniteOnBlackPicturesAndOnePixel) {
  const Image black(6, 5, 3), one = random_image(1, 1, 3, 6, 0, 40);
  for (const float error : hdr_flip(black, black, flip_exposures(black)).pixels)
    EXPECT_EQ(error, 0);
  Image spot(6, 5, 3);
  spot.set_rgb(2, 2, {1e6f, 1e6f, 1e6f});
  EXPECT_LE(flip_exposures(spot).count, 24) << "the median is black";
  for (const float error : hdr_flip(black, spot, flip_exposures(spot)).pixels)
    EXPECT_TRUE(std::isfinite(error));
  EXPECT_TRUE(std::isfinite(hdr_flip(Image(1, 1, 3), one, flip_exposures(one)).pixels[0]));
}

TEST(Flip, ExposuresAndMeanLookAtTheMaskAlone) {
  Image picture = random_image(8, 4, 3, 7, 1, 2);
  const FlipExposures before = flip_exposures(picture);
  Image wider(8, 5, 3);
  std::copy(picture.pixels.begin(), picture.pixels.end(), wider.pixels.begin());
  std::vector<uint8_t> mask(40, 1);
  std::fill(mask.begin() + 32, mask.end(), uint8_t{0});
  const FlipExposures masked = flip_exposures(wider, mask);
  EXPECT_EQ(before.start, masked.start);
  EXPECT_EQ(before.stop, masked.stop);
  Image scalar(2, 1, 1);
  scalar.pixels = {1, 3};
  EXPECT_EQ(masked_mean(scalar, std::vector<uint8_t>{0, 1}), 3);
  EXPECT_EQ(masked_mean(scalar, std::vector<uint8_t>{0, 0}), 0);
}

TEST(Flip, RefusesWhatItCannotCompare) {
  const Image a(4, 3, 3);
  EXPECT_THAT(error_of([&] { flip(a, Image(4, 4, 3)); }), HasSubstr("4 x 3"));
  EXPECT_THAT(error_of([&] { flip(Image(4, 3, 1), a); }), HasSubstr("3 channels"));
  EXPECT_THAT(error_of([&] { flip(a, a, 0); }), HasSubstr("pixels per degree"));
}

}  // namespace
}  // namespace lte::image
