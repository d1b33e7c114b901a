#include "lte/image/metrics.h"

#include <cmath>

#include <gmock/gmock.h>

#include "lte/base/parallel.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::random_image;
using testing::HasSubstr;

using Values = std::vector<float>;

TEST(Mse, SmallValues) {
  EXPECT_EQ(mse(Values{1, 2, 3}, Values{1, 2, 3}), 0);
  EXPECT_DOUBLE_EQ(mse(Values{1, 2, 3}, Values{2, 2, 1}), 5.0 / 3);
  EXPECT_DOUBLE_EQ(mse(Values{2, 2, 1}, Values{1, 2, 3}), 5.0 / 3);
  EXPECT_TRUE(std::isnan(mse(Values{NAN}, Values{1})));
}

TEST(Psnr, IsTenLogTenAndCapped) {
  EXPECT_NEAR(psnr(0.01, 1), 20, 1e-12);
  EXPECT_NEAR(psnr(0.01, 10), 40, 1e-12);
  EXPECT_NEAR(psnr(4, 1), -6.0206, 1e-4);
  EXPECT_EQ(psnr(0, 1), 100);
  EXPECT_EQ(psnr(1e-30, 1), 100);
  EXPECT_TRUE(std::isnan(psnr(NAN, 1)));
  EXPECT_THAT(error_of([] { psnr(1, 0); }), HasSubstr("peak"));
}

TEST(RelativeMse, SmallValues) {
  EXPECT_NEAR(relative_mse(Values{3, 0}, Values{2, 0}), 0.5 * 1 / 4.01, 1e-12);
  EXPECT_NEAR(relative_mse(Values{1}, Values{0}, 0.5), 2, 1e-12);
}

TEST(RelativeMse, HardlyDependsOnTheScaleOfBrightPictures) {
  const Image a = random_image(32, 32, 3, 1, 1, 2), b = random_image(32, 32, 3, 2, 1, 2);
  Values bright_a, bright_b;
  for (const float value : a.pixels) bright_a.push_back(1000 * value);
  for (const float value : b.pixels) bright_b.push_back(1000 * value);
  EXPECT_NEAR(relative_mse(a.pixels, b.pixels) / relative_mse(bright_a, bright_b), 1, 0.01);
}

TEST(LogRelativeL2, SmallValues) {
  const double e = std::exp(1.0);
  const auto one = static_cast<float>(e - 1);            // log(1 + x) = 1
  const auto three = static_cast<float>(e * e * e - 1);  // = 3
  EXPECT_NEAR(log_relative_l2(Values{three}, Values{one}, 0), 4, 1e-6);
  EXPECT_NEAR(log_relative_l2(Values{one}, Values{three}, 0), 4.0 / 9, 1e-6);
  EXPECT_NEAR(log_relative_l2(Values{one}, Values{0}), 1e4, 1e-2);
  EXPECT_EQ(log_relative_l2(Values{-5}, Values{0}), 0);
  EXPECT_EQ(log_relative_l2(Values{0}, Values{-5}), 0);
  EXPECT_TRUE(std::isnan(log_relative_l2(Values{NAN}, Values{1})));
}

TEST(Metrics, RefuseDifferentSizesAndNothing) {
  for (const auto metric :
       {+[](std::span<const float> a, std::span<const float> b) { return mse(a, b); },
        +[](std::span<const float> a, std::span<const float> b) { return relative_mse(a, b); },
        +[](std::span<const float> a, std::span<const float> b) {
          return log_relative_l2(a, b);
        }}) {
    EXPECT_THAT(error_of([&] {
                  metric(Values{1, 2}, Values{1});
                }),
                HasSubstr("sizes differ: 2 and 1"));
    EXPECT_THAT(error_of([&] { metric(Values{}, Values{}); }), HasSubstr("no values"));
  }
}

TEST(Metrics, AreTheSameBitsForAnyNumberOfThreads) {
  const Image a = random_image(300, 301, 3, 1), b = random_image(300, 301, 3, 2);
  set_num_threads(1);
  const double one[] = {mse(a.pixels, b.pixels), relative_mse(a.pixels, b.pixels),
                        log_relative_l2(a.pixels, b.pixels), ssim(a, b)};
  set_num_threads(5);
  const double five[] = {mse(a.pixels, b.pixels), relative_mse(a.pixels, b.pixels),
                         log_relative_l2(a.pixels, b.pixels), ssim(a, b)};
  set_num_threads(0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(one[i], five[i]);
}

TEST(Metrics, LargeSumsKeepTheirDigits) {
  const Values a(3'000'000, 0.1f), b(3'000'000, 0.0f);
  EXPECT_NEAR(mse(a, b), static_cast<double>(0.1f) * static_cast<double>(0.1f), 1e-13);
}

}  // namespace
}  // namespace lte::image
