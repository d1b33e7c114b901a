// What is restored to a denoised picture: what it has lost, and no noise.
#include "lte/render/lost_detail.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::render {
namespace {

constexpr int kAcross = 64, kDown = 48;
constexpr size_t kPixels = size_t{kAcross} * kDown;

/// Light with a shadow's edge down the middle.
Rgb truth(size_t pixel) {
  const float light = pixel % kAcross < kAcross / 2 ? 1.0f : 0.25f;
  return {light, 0.8f * light, 0.5f * light};
}

/// Halves of `samples` samples each, whose noise is as large as the light.
LightEstimate sampled(int samples, uint64_t seed) {
  Rng rng(seed);
  LightEstimate out;
  for (LightSums& half : out.halves) {
    half = LightSums(kAcross, kDown);
    for (size_t i = 0; i < kPixels; ++i) {
      for (int k = 0; k < samples; ++k) half.add(i, {{}, {}, truth(i) * (2 * rng.uniform())}, 1);
    }
  }
  return out;
}

image::Image blurred(int radius) {
  image::Image out(kAcross, kDown, 3);
  for (size_t i = 0; i < kPixels; ++i) {
    const auto x = static_cast<int>(i % kAcross);
    Rgb sum;
    for (int dx = -radius; dx <= radius; ++dx)
      sum += truth(static_cast<size_t>(std::clamp(x + dx, 0, kAcross - 1)));
    out.set_rgb(i, sum * (1 / static_cast<float>(2 * radius + 1)));
  }
  return out;
}

double error_of(const image::Image& image) {
  double sum = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    const Rgb off = image.rgb(i) - truth(i);
    sum += double{dot(off, off)};
  }
  return std::sqrt(sum / kPixels);
}

image::Image restored(const LightEstimate& samples, image::Image smooth, bool metal = false) {
  Film film(kAcross, kDown);
  film.gathered = samples;
  film.has_metal.assign(kPixels, metal ? 1 : 0);
  restore_lost_detail(film, &LightSums::indirect, &smooth);
  return smooth;
}

TEST(LostDetail, OfManySamplesIsRestored) {
  const LightEstimate samples = sampled(256, 1);
  const image::Image smooth = blurred(3), found = restored(samples, smooth);
  EXPECT_LT(error_of(found), 0.4 * error_of(smooth));
  EXPECT_LT(error_of(found), error_of(samples.mean().indirect));
}

TEST(LostDetail, NoiseIsNot) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    const LightEstimate samples = sampled(4, seed);
    const image::Image found = restored(samples, blurred(0));
    EXPECT_LT(error_of(found), 0.1 * error_of(samples.mean().indirect));
  }
}

/// Beside bright noise, and of a picture that is its samples' mean.
TEST(LostDetail, InTheDarkIsNothing) {
  Rng rng(5);
  LightEstimate samples;
  for (LightSums& half : samples.halves) {
    half = LightSums(kAcross, kDown);
    for (size_t i = 0; i < kPixels; ++i) {
      const bool bright = i % kAcross < 20 && i / kAcross < 20;
      half.add(i, {{}, {}, bright ? Rgb{1, 1, 1} * std::exp(-20 * rng.uniform()) : Rgb{}}, 1);
    }
  }
  const image::Image mean = samples.mean().indirect, found = restored(samples, mean);
  for (size_t k = 0; k < mean.pixels.size(); ++k)
    ASSERT_NEAR(found.pixels[k], mean.pixels[k], 1e-6);
}

/// A layer that few samples have found, and of which the denoiser has left nothing.
TEST(LostDetail, OfALayerWithNearlyNoLightIsFinite) {
  LightEstimate samples;
  for (LightSums& half : samples.halves) {
    half = LightSums(kAcross, kDown);
    for (size_t i = 0; i < kPixels; ++i) half.add(i, {{}, {}, i == 777 ? Rgb{1, 1, 1} : Rgb{}}, 1);
  }
  samples.halves[1].indirect.set_rgb(777, {1e-3f, 1, 2});
  const image::Image found = restored(samples, image::Image(kAcross, kDown, 3));
  for (const float value : found.pixels) ASSERT_TRUE(std::isfinite(value) && value >= 0);
  LightEstimate none;
  for (LightSums& half : none.halves) {
    half = LightSums(kAcross, kDown);
    for (size_t i = 0; i < kPixels; ++i) half.add(i, {}, 1);
  }
  EXPECT_EQ(restored(none, blurred(0)).pixels, blurred(0).pixels);
}

TEST(LostDetail, NeedsBothHalvesAndNoMetal) {
  const image::Image smooth = blurred(3);
  LightEstimate samples = sampled(64, 1);
  EXPECT_NE(restored(samples, smooth).pixels, smooth.pixels);
  EXPECT_EQ(restored(samples, smooth, /*metal=*/true).pixels, smooth.pixels);
  samples.halves[1] = {};
  EXPECT_EQ(restored(samples, smooth).pixels, smooth.pixels);
}

}  // namespace
}  // namespace lte::render
