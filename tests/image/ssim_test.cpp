#include <cmath>

#include <gmock/gmock.h>

#include "lte/image/metrics.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::random_image;
using testing::HasSubstr;

/// Wang et al. 2004, equation 13, written down as it stands: a two-dimensional window, central
/// moments, one pixel after another.
double reference_ssim(const Image& a, const Image& b, const std::vector<uint8_t>& mask = {}) {
  double sum = 0;
  int count = 0;
  for (int c = 0; c < a.channels; ++c) {
    for (int y = 5; y < a.height - 5; ++y) {
      for (int x = 5; x < a.width - 5; ++x) {
        if (!mask.empty() && mask[static_cast<size_t>(y * a.width + x)] == 0) continue;
        double total = 0, mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, covar = 0;
        const auto for_window = [&](const auto& visit) {
          for (int j = -5; j <= 5; ++j) {
            for (int i = -5; i <= 5; ++i) {
              visit(std::exp(-(i * i + j * j) / (2 * 1.5 * 1.5)), double{a.at(x + i, y + j)[c]},
                    double{b.at(x + i, y + j)[c]});
            }
          }
        };
        for_window([&](double w, double p, double q) {
          total += w;
          mean_a += w * p;
          mean_b += w * q;
        });
        mean_a /= total;
        mean_b /= total;
        for_window([&](double w, double p, double q) {
          var_a += w / total * (p - mean_a) * (p - mean_a);
          var_b += w / total * (q - mean_b) * (q - mean_b);
          covar += w / total * (p - mean_a) * (q - mean_b);
        });
        const double c1 = 1e-4, c2 = 9e-4;
        sum += (2 * mean_a * mean_b + c1) * (2 * covar + c2) /
               ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(Ssim, MatchesTheDefinitionWrittenOutDirectly) {
  for (const auto& [width, height, channels] :
       {std::tuple{11, 11, 1}, {12, 11, 3}, {30, 55, 3}, {17, 43, 1}}) {
    const Image b = random_image(width, height, channels, 1);
    Image a = b;
    Rng rng(2);
    for (float& value : a.pixels) value = std::clamp(value + rng.uniform(-0.2f, 0.3f), 0.0f, 1.0f);
    EXPECT_NEAR(ssim(a, b), reference_ssim(a, b), 1e-10) << width << " x " << height;
  }
}

TEST(Ssim, IsOneForEqualPicturesAndSymmetric) {
  const Image a = random_image(40, 30, 3, 1), b = random_image(40, 30, 3, 2);
  EXPECT_NEAR(ssim(a, a), 1, 1e-12);
  EXPECT_NEAR(ssim(a, b), ssim(b, a), 1e-12);
  EXPECT_LT(ssim(a, b), 0.2);
}

TEST(Ssim, OfConstantPicturesIsTheLuminanceTerm) {
  Image a(16, 16, 1), b(16, 16, 1);
  a.pixels.assign(256, 0.25f);
  b.pixels.assign(256, 0.75f);
  EXPECT_NEAR(ssim(a, b), (2 * 0.25 * 0.75 + 1e-4) / (0.0625 + 0.5625 + 1e-4), 1e-9);
}

TEST(Ssim, IsNegativeForInvertedStructure) {
  const Image a = random_image(32, 32, 1, 1);
  Image b = a;
  for (float& value : b.pixels) value = 1 - value;
  EXPECT_LT(ssim(a, b), -0.5);
}

TEST(Ssim, MaskSelectsPixels) {
  const Image b = random_image(40, 50, 3, 1);
  Image a = b;
  for (int y = 0; y < 50; ++y) {
    for (int x = 20; x < 40; ++x) a.set_rgb(x, y, {0, 0, 0});
  }
  std::vector<uint8_t> mask(40 * 50);
  Rng rng(3);
  for (uint8_t& entry : mask) entry = rng.below(3) == 0 ? 255 : 0;
  EXPECT_NEAR(ssim(a, b, mask), reference_ssim(a, b, mask), 1e-10);
  for (size_t i = 0; i < mask.size(); ++i)
    mask[i] = i % 40 < 15;  // windows that end before the damage
  EXPECT_NEAR(ssim(a, b, mask), 1, 1e-12);
  const std::vector<uint8_t> nothing(mask.size());
  EXPECT_EQ(ssim(a, b, nothing), 1);
}

TEST(Ssim, RefusesWrongSizes) {
  const Image a(20, 20, 3);
  EXPECT_THAT(error_of([&] { ssim(a, Image(20, 21, 3)); }), HasSubstr("sizes differ"));
  EXPECT_THAT(error_of([&] { ssim(a, Image(20, 20, 1)); }), HasSubstr("sizes differ"));
  EXPECT_THAT(error_of([&] { ssim(Image(10, 20, 3), Image(10, 20, 3)); }),
              HasSubstr("at least 11"));
  EXPECT_THAT(error_of([&] { ssim(a, a, std::vector<uint8_t>(399)); }),
              HasSubstr("mask of 400 entries, got 399"));
}

}  // namespace
}  // namespace lte::image
