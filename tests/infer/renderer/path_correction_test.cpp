// Correction by paths on made-up pictures whose truth and noise are known.
#include "infer/renderer/path_correction.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kSide = 64;

/// A plane that is seen from above.
SurfaceGuides plane() {
  SurfaceGuides out;
  out.normal = out.position = out.albedo = Image(kSide, kSide, 3);
  out.mask.assign(kSide * kSide, 1);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      out.normal.set_rgb(x, y, {0, 1, 0});
      out.position.set_rgb(x, y, {static_cast<float>(x), 0, static_cast<float>(y)});
    }
  }
  return out;
}

/// Light with a hard edge.
Image truth() {
  Image out(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) out.set_rgb(x, y, x < kSide / 2 ? Rgb{3, 2, 1} : Rgb{1, 1, 1});
  return out;
}

Image noisy(double sigma, uint64_t seed) {
  Image out = truth();
  Rng rng(seed, 0);
  for (float& value : out.pixels) {
    double sum = -6;  // of twelve uniform numbers: nearly normal, variance 1
    for (int k = 0; k < 12; ++k) sum += double{rng.uniform()};
    value += static_cast<float>(sigma * sum);
  }
  return out;
}

double mse(const Image& found) {
  const Image wanted = truth();
  double sum = 0;
  for (size_t i = 0; i < found.pixels.size(); ++i) {
    const double apart = double{found.pixels[i]} - double{wanted.pixels[i]};
    sum += apart * apart;
  }
  return sum / static_cast<double>(found.pixels.size());
}

Image corrected(const Image& answer, double sigma) {
  const SurfaceGuides guides = plane();
  return correct_by_paths(guides, guides.mask, answer, noisy(sigma, 1), noisy(sigma, 2));
}

TEST(PathCorrection, AWrongAnswerFallsToTheNoiseOfThePaths) {
  Image wrong = truth();
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {  // too bright, and with a pattern of a pixel's size
      const float factor = 1.3f + ((x + y) % 2 == 0 ? 0.1f : -0.1f);
      wrong.set_rgb(x, y, wrong.rgb(x, y) * factor);
    }
  }
  for (const double sigma : {0.3, 0.03, 0.003}) {
    const double noise = sigma * sigma / 2;  // of the mean of both halves
    EXPECT_LT(mse(corrected(wrong, sigma)), 1.2 * noise + 1e-9) << sigma;
  }
  // Many pixels share the error where paths are few, so it falls far below a pixel's own noise.
  Image bright = truth();
  for (float& value : bright.pixels) value *= 1.3f;
  EXPECT_LT(mse(corrected(bright, 1)), 0.1 * 0.5);
}

TEST(PathCorrection, ARightAnswerIsLeftAlone) {
  for (const double sigma : {1.0, 0.1})
    EXPECT_LT(mse(corrected(truth(), sigma)), 6e-5 * sigma * sigma) << sigma;
}

/// Noise as it is where paths are few: one value in fifty has it all.
TEST(PathCorrection, FewPathsWithHeavyTailsDoNoHarm) {
  const auto spiked = [](uint64_t seed) {
    Image out = truth();
    Rng rng(seed, 1);
    for (float& value : out.pixels) value += rng.uniform() < 0.02f ? 49.0f : -1.0f;
    return out;
  };
  constexpr double kVariance = 49.0 / 2;  // of the mean of both halves
  constexpr uint64_t kSeeds = 8;
  const SurfaceGuides guides = plane();
  double sum = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed)
    sum += mse(correct_by_paths(guides, guides.mask, truth(), spiked(seed), spiked(seed + 100)));
  EXPECT_LT(sum / kSeeds, 2e-4 * kVariance);
}

/// What is wrong by far at a few pixels is no reason to take the noise of the paths beside them: no
/// square of grain around a lamp.
TEST(PathCorrection, AFaultOfAFewPixelsLetsNoGrainInAroundIt) {
  constexpr int kSpot = 4, kMiddle = kSide / 4;  // half an edge of what is wrong
  constexpr double kSigma = 0.5;
  Image wrong = truth();
  const auto apart = [](int x, int y) {
    return std::max(std::abs(x - kMiddle), std::abs(y - kSide / 2));
  };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (apart(x, y) < kSpot) wrong.set_rgb(x, y, wrong.rgb(x, y) * 0.1f);
    }
  }
  const Image out = corrected(wrong, kSigma);
  const Image wanted = truth();
  double spot = 0, around = 0, spots = 0, arounds = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide / 2; ++x) {
      const double off = double{out.rgb(x, y).x} - double{wanted.rgb(x, y).x};
      const int far = apart(x, y);
      (far < kSpot ? spot : around) += far < kSpot || far > 2 * kSpot ? off * off : 0;
      (far < kSpot ? spots : arounds) += far < kSpot || far > 2 * kSpot ? 1 : 0;
    }
  }
  EXPECT_LT(around / arounds, 0.01 * kSigma * kSigma / 2) << "of what the paths' mean has";
  EXPECT_LT(spot / spots, 0.2 * 2.7 * 2.7) << "of what the answer was wrong by";
}

TEST(PathCorrection, NothingLeavesTheMask) {
  const SurfaceGuides guides = plane();
  std::vector<uint8_t> mask(guides.mask);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % kSide < 20 ? 1 : 0;
  Image answer = truth(), a = noisy(0.01, 1), b = noisy(0.01, 2);
  for (size_t i = 0; i < mask.size(); ++i) {
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      if (mask[i] == 0) answer.pixels[k] = a.pixels[k] = b.pixels[k] = 1000.0f + (k % 7);
    }
  }
  const Image out = correct_by_paths(guides, mask, answer, a, b);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (x < 20) {
        EXPECT_NEAR(out.rgb(x, y).x, 3, 0.1);
      } else {
        EXPECT_EQ(out.rgb(x, y), answer.rgb(x, y));
      }
    }
  }
  EXPECT_THROW(correct_by_paths(guides, mask, answer, a, Image(4, 4, 3)), Error);
}

}  // namespace
}  // namespace lte::infer
