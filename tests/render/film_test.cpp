// Sums of a film: means, halves, and how far the halves differ.
#include "lte/render/film.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::render {
namespace {

using pathtrace::PixelRadiance;

LightSums sums_of(int width, int height) {
  LightSums out;
  out.emission = out.direct = out.indirect = image::Image(width, height, 3);
  out.samples.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
  return out;
}

PixelRadiance gray(float direct, float indirect) {
  return {{}, {direct, direct, direct}, {indirect, indirect, indirect}};
}

TEST(LightEstimate, TheMeanIsThatOfAllSamplesAndHalvesKeepTheirOwn) {
  LightEstimate light;
  EXPECT_TRUE(light.empty());
  light.halves[0] = sums_of(2, 1);
  light.halves[1] = sums_of(2, 1);
  light.halves[0].add(0, gray(4, 1), 2);
  light.halves[1].add(0, gray(8, 2), 1);
  EXPECT_EQ(light.mean().direct.rgb(0), (Rgb{4, 4, 4}));
  EXPECT_EQ(light.mean().indirect.rgb(0), (Rgb{1, 1, 1}));
  EXPECT_EQ(light.mean_of(0).direct.rgb(0), (Rgb{2, 2, 2}));
  EXPECT_EQ(light.mean_of(1).direct.rgb(0), (Rgb{8, 8, 8}));
  EXPECT_EQ(light.mean().direct.rgb(1), Rgb{}) << "no samples";
  light.forget(0);
  EXPECT_EQ(light.mean().direct.rgb(0), Rgb{});
}

TEST(LightEstimate, APixelThatOneHalfLacksTakesTheOthers) {
  LightEstimate light;
  light.halves[0] = sums_of(1, 1);
  light.halves[0].add(0, gray(6, 0), 3);
  EXPECT_EQ(light.mean_of(1).direct.rgb(0), (Rgb{2, 2, 2}));
  EXPECT_TRUE(std::isinf(light.relative_error()));
}

TEST(LightEstimate, TheHalvesTellTheStandardErrorOfTheMean) {
  constexpr int kSide = 64, kSamples = 8;
  LightEstimate light;
  Rng rng(5);
  for (LightSums& half : light.halves) {
    half = sums_of(kSide, kSide);
    for (size_t i = 0; i < half.samples.size(); ++i) {
      for (int k = 0; k < kSamples; ++k) half.add(i, gray(rng.uniform(0, 2), 0), 1);
    }
  }
  // Uniform on [0, 2]: mean 1, variance 1/3, of 16 samples a pixel.
  EXPECT_NEAR(light.relative_error(), std::sqrt(1.0 / 3 / 16), 0.005);
}

}  // namespace
}  // namespace lte::render
