// The error against two references, on pictures whose error and noise are made by hand.
#include "infer/eval/measure/pair_error.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lte::infer {
namespace {

using image::Image;

/// A truth that changes over the picture, between 1 and 2.
Image smooth_truth(int width, int height) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float level = 1 + static_cast<float>(x + y) / static_cast<float>(width + height);
      out.set_rgb(x, y, {level, 0.9F * level, 1.1F * level});
    }
  }
  return out;
}

/// The mean of so many draws at each value, each exponentially distributed around the truth.
Image sampled(const Image& truth, int draws, std::mt19937* random) {
  Image out = truth;
  std::gamma_distribution<double> mean(draws, 1.0 / draws);
  for (float& value : out.pixels) value = static_cast<float>(double{value} * mean(*random));
  return out;
}

struct Spread {
  double mean = 0, stderr_of_mean = 0, deviation = 0;
};

Spread spread_of(const std::vector<double>& values) {
  Spread out;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) out.mean += value / count;
  double squares = 0;
  for (const double value : values) squares += (value - out.mean) * (value - out.mean);
  out.deviation = std::sqrt(squares / (count - 1));
  out.stderr_of_mean = out.deviation / std::sqrt(count);
  return out;
}

/// Errors of +0.3 in the left half and, pixel by pixel, of +-0.2 in the right one, which blocks do
/// not see.
Image with_known_error(const Image& truth) {
  Image out = truth;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const float error = x < out.width / 2 ? 0.3F : (x + y) % 2 == 0 ? 0.2F : -0.2F;
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] += error;
    }
  }
  return out;
}

TEST(PairError, IsUnbiasedWhateverTheNoiseOfTheReferences) {
  const Image truth = smooth_truth(32, 24), picture = with_known_error(truth);
  const double mse = 0.5 * (0.09 + 0.04), block_mse = 0.5 * 0.09;
  std::mt19937 random(5);
  std::vector<double> errors, block_errors, ratios;
  for (int k = 0; k < 400; ++k) {
    const Image a = sampled(truth, 4, &random), b = sampled(truth, 4, &random);
    const PairError found = pair_error(picture, a, b, {}, 4);
    // The cap is far above what four draws give, but for a few in a million.
    errors.push_back(found.mse);
    block_errors.push_back(std::pow(found.block_error * found.mean, 2));
    ratios.push_back(found.mean_ratio);
  }
  const Spread error = spread_of(errors), block = spread_of(block_errors);
  EXPECT_NEAR(error.mean, mse, 4 * error.stderr_of_mean);
  EXPECT_NEAR(block.mean, block_mse, 4 * block.stderr_of_mean);
  EXPECT_LT(4 * error.stderr_of_mean, 0.06 * mse) << "or the test says nothing";
  EXPECT_LT(4 * block.stderr_of_mean, 0.06 * block_mse);
  // A measure against a single reference would be off by its noise, which is a quarter of the
  // squared truth: nine times the error.
  EXPECT_NEAR(spread_of(ratios).mean, 1 + 0.15 / 1.5, 0.01);
}

TEST(PairError, StandardErrorIsTheSpreadOfTheError) {
  const Image truth = smooth_truth(64, 48);
  Image picture = truth;
  for (float& value : picture.pixels) value += 0.1F;
  std::mt19937 random(6);
  std::vector<double> errors;
  double told = 0;
  constexpr int kTimes = 200;
  for (int k = 0; k < kTimes; ++k) {
    const PairError found =
        pair_error(picture, sampled(truth, 16, &random), sampled(truth, 16, &random), {}, 16);
    errors.push_back(found.mse);
    told += found.mse_stderr / kTimes;
  }
  EXPECT_NEAR(told / spread_of(errors).deviation, 1, 0.2);
}

TEST(PairError, PathsAreWorthTheirNumber) {
  const Image truth = smooth_truth(96, 72);
  std::mt19937 random(7);
  for (const int paths : {1, 16, 64}) {
    const Image picture = sampled(truth, paths, &random);
    const PairError found =
        pair_error(picture, sampled(truth, 128, &random), sampled(truth, 128, &random), {}, 128);
    EXPECT_NEAR(found.worth / paths, 1, 0.1) << paths;
    EXPECT_NEAR(found.mean_ratio, 1, 0.02);
    EXPECT_FALSE(found.below_noise);
    EXPECT_EQ(found.is_right(), paths >= 64 ? found.worth >= 64 : false);
  }
}

TEST(PairError, OfTheTruthItselfTheWorthIsABound) {
  const Image truth = smooth_truth(64, 48);
  std::mt19937 random(8);
  int below = 0;
  for (int k = 0; k < 40; ++k) {
    const PairError found =
        pair_error(truth, sampled(truth, 16, &random), sampled(truth, 16, &random), {}, 16);
    EXPECT_EQ(found.below_noise, found.mse <= 0);
    EXPECT_GT(found.worth, 500);  // what 16 paths can tell at 9,216 values
    if (!found.below_noise) continue;
    ++below;
    EXPECT_DOUBLE_EQ(found.worth, found.path_variance / (2 * found.mse_stderr));
    EXPECT_TRUE(found.is_right());
  }
  EXPECT_GT(below, 8);
  EXPECT_LT(below, 32);
}

TEST(PairError, FirefliesCountAsFourTimesTheQuantile) {
  Image a(40, 40, 3);
  std::fill(a.pixels.begin(), a.pixels.end(), 1.0F);
  Image b = a, picture = a;
  picture.at(3, 5)[1] = 1e6F;
  const PairError bright = pair_error(picture, a, b, {}, 8);
  EXPECT_DOUBLE_EQ(bright.cap, 4);
  EXPECT_NEAR(bright.mse, 9.0 / (3 * 40 * 40), 1e-12);
  EXPECT_NEAR(bright.mean_ratio, 1 + 3.0 / (3 * 40 * 40), 1e-12);
  b.at(9, 9)[0] = 1e6F;  // one value of 4,800 is beyond the quantile
  const PairError both = pair_error(a, a, b, {}, 8);
  EXPECT_DOUBLE_EQ(both.cap, 4);
  EXPECT_NEAR(both.path_variance, 8 * 9.0 / (3 * 40 * 40) / 2, 1e-12);
}

TEST(PairError, CountsWhatTheMaskHas) {
  const Image truth = smooth_truth(20, 13);
  Image picture = truth;
  std::vector<uint8_t> mask(20 * 13, 1);
  for (int y = 0; y < 13; ++y) {
    mask[static_cast<size_t>(y) * 20] = 0;
    picture.at(0, y)[0] = 50;
  }
  const PairError found = pair_error(picture, truth, truth, mask, 1);
  EXPECT_EQ(found.pixels, 19 * 13);
  EXPECT_EQ(found.mse, 0);
  EXPECT_EQ(found.block_error, 0);
  EXPECT_EQ(found.mean_ratio, 1);
  EXPECT_EQ(found.path_variance, 0);
  EXPECT_TRUE(found.is_right()) << "where paths do not vary, mean and blocks decide";
  EXPECT_GT(pair_error(picture, truth, truth, {}, 1).mse, 0.5);
}

TEST(PairError, OfADarkReferenceIsNone) {
  const Image dark(16, 16, 3);
  Image picture = dark;
  picture.pixels[0] = 1;
  const PairError found = pair_error(picture, dark, dark, {}, 4);
  EXPECT_FALSE(found.measured());
  EXPECT_FALSE(found.is_right());
  EXPECT_TRUE(std::isnan(found.mean_ratio) && std::isnan(found.mse) && std::isnan(found.worth));
  EXPECT_THROW(pair_error(Image(8, 8, 3), dark, dark, {}, 4), Error);
}

TEST(PairError, APixelThatIsNoNumberIsAFault) {
  const Image truth = smooth_truth(20, 13);
  Image picture = truth;
  picture.at(3, 7)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { pair_error(picture, truth, truth, {}, 1); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("pixel 3, 7 of the picture")));
}

}  // namespace
}  // namespace lte::infer
