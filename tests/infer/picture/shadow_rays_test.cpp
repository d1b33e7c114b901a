// Shadow rays shared out over pixels: no bias, and more of them where the noise is.
#include "infer/picture/shadow_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

constexpr int kWidth = 24, kHeight = 16;

/// A plate over the floor of test::lit_floor() throws a shadow with a wide penumbra.
struct Penumbra {
  Penumbra() : scene(make()), bvh(scene), lights(scene) {
    scene::Camera camera = test::downward_camera();
    camera.origin = {0, 0.9f, 0.01f};  // from under the plate
    guides = trace_guides(bvh, camera, kWidth, kHeight);
  }
  static scene::Scene make() {
    scene::Scene out = test::lit_floor();
    const int grey = test::add_material(&out, {0.3f, 0.3f, 0.3f}, {}, true);
    test::add_quad(&out, {0, 1, -2}, {2, 0, 0}, {0, 0, 4}, grey);
    return out;
  }
  PixelLight light(int samples, bool adaptive, uint64_t seed) const {
    return light_pixels(bvh, lights, guides, {samples, adaptive, false, seed});
  }

  scene::Scene scene;
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
  SurfaceGuides guides;
};

TEST(ShadowRays, SharedOutHaveTheMeanOfEvenOnes) {
  const Penumbra picture;
  const PixelLight reference = picture.light(1 << 13, false, 77);
  const size_t pixels = picture.guides.pixels();
  std::vector<double> sum(pixels), squares(pixels);
  constexpr int kSeeds = 600;
  int64_t rays = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const PixelLight light = picture.light(8, true, static_cast<uint64_t>(seed));
    rays += light.rays;
    for (size_t i = 0; i < pixels; ++i) {
      const double value = light.irradiance.pixels[3 * i];
      sum[i] += value;
      squares[i] += value * value;
    }
  }
  const auto surfaces =
      std::accumulate(picture.guides.mask.begin(), picture.guides.mask.end(), 0.0);
  EXPECT_NEAR(static_cast<double>(rays) / kSeeds / surfaces, 8, 0.1);
  double chi2 = 0, all = 0, all_wanted = 0, all_variance = 0;
  int noisy = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const double mean = sum[i] / kSeeds, wanted = reference.irradiance.pixels[3 * i];
    const double variance = (squares[i] - sum[i] * mean) / (kSeeds - 1) / kSeeds;
    all += mean;
    all_wanted += wanted;
    all_variance += variance;
    if (!(variance > 1e-9 * wanted * wanted)) continue;
    EXPECT_NEAR(mean, wanted, 5.5 * std::sqrt(variance) + 2e-3 * wanted) << "pixel " << i;
    chi2 += (mean - wanted) * (mean - wanted) / (variance + 1e-6 * wanted * wanted);
    ++noisy;
  }
  EXPECT_GT(noisy, 200);
  EXPECT_LT(chi2 / noisy, 1.35);
  EXPECT_NEAR(all, all_wanted, 4 * std::sqrt(all_variance) + 3e-4 * all_wanted);
}

/// On one plane of one brightness, in proportion to the standard error: twice as many where the
/// variance is four times as large.
TEST(ShadowRays, AreMoreWhereTheNoiseIs) {
  const Penumbra picture;
  const size_t pixels = picture.guides.pixels();
  const std::vector<Rgb> irradiance(pixels, Rgb{1, 1, 1});
  std::vector<float> variance(pixels);
  for (size_t i = 0; i < pixels; ++i) variance[i] = i % kWidth < kWidth / 2 ? 0.01f : 0.04f;
  const RayCounts counts = share_rays(picture.guides, {irradiance, variance, 2}, 60, 1);
  double left = 0, right = 0, all = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const size_t x = i % kWidth;
    all += counts.rays[i];
    if (x < 9) left += counts.rays[i] / (9.0 * kHeight);
    if (x >= 15) right += counts.rays[i] / (9.0 * kHeight);
  }
  EXPECT_NEAR(all / static_cast<double>(pixels), 60, 0.5);
  EXPECT_NEAR(right / left, 2, 0.02);
}

/// What makes them unbiased: no count of a color changes with any pilot of that color.
TEST(ShadowRays, OfAPixelDoNotDependOnItsOwnPilotNorOnItsColor) {
  const Penumbra picture;
  const size_t pixels = picture.guides.pixels();
  std::vector<Rgb> irradiance(pixels, Rgb{1, 1, 1});
  std::vector<float> variance(pixels, 0.1f);
  for (size_t i = 0; i < pixels; ++i) variance[i] += 0.01f * static_cast<float>(i % 5);
  const RayCounts before = share_rays(picture.guides, {irradiance, variance, 2}, 6, 1);
  for (size_t i = 0; i < pixels; ++i) {
    if ((i % kWidth + i / kWidth) % 2 == 1) continue;
    variance[i] = static_cast<float>(i % 11);
    irradiance[i] = Rgb{1, 1, 1} * static_cast<float>(i % 3);
  }
  const RayCounts after = share_rays(picture.guides, {irradiance, variance, 2}, 6, 1);
  int changed = 0;
  for (size_t i = 0; i < pixels; ++i) {
    if ((i % kWidth + i / kWidth) % 2 == 0) {
      EXPECT_EQ(after.rays[i], before.rays[i]) << "pixel " << i;
    } else {
      changed += after.rays[i] != before.rays[i] ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 20) << "the pilots must have had something to decide";
  EXPECT_LE(*std::max_element(after.rays.begin(), after.rays.end()), 16 * 6 + 1);
}

}  // namespace
}  // namespace lte::infer
