// Shares of a way that noisy samples tell, against the truth that they are drawn from.
#include "lte/render/way_regression.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::render {
namespace {

constexpr size_t kWindows = 400, kPoints = 100;  // of each
constexpr float kOfPaths = 0.2f;                 // error of what paths found, a window and half

float normal(Rng* rng) {
  float sum = -6;
  for (int k = 0; k < 12; ++k) sum += rng->uniform();
  return sum;
}

Rgb gray(float value) { return {value, value, value}; }

std::vector<float> window_means(std::vector<float> values) {
  for (size_t w = 0; w < kWindows; ++w) {
    double sum = 0;
    for (size_t i = 0; i < kPoints; ++i) sum += double{values[w * kPoints + i]};
    for (size_t i = 0; i < kPoints; ++i)
      values[w * kPoints + i] = static_cast<float>(sum / kPoints);
  }
  return values;
}

/// Of light of 1, of which an estimate is off by `shift` and a share of `wrong` in each window:
/// root mean square error after it was drawn towards paths, without and with shrinking.
std::pair<double, double> errors(float shift, float wrong, float noise_of_samples) {
  Rng rng(3, 1);
  WayRegression regression(kWindows * kPoints);
  std::vector<float> noise(kWindows * kPoints);
  std::vector<Rgb> from, to;
  for (size_t w = 0; w < kWindows; ++w) {
    const Rgb at = gray(1 + shift + wrong * normal(&rng));
    std::array<Rgb, 2> found;
    for (Rgb& half : found) half = gray(1 + kOfPaths * normal(&rng));
    for (size_t i = 0; i < kPoints; ++i) {
      const size_t point = w * kPoints + i;
      for (const Rgb& half : found)
        regression.add(point, 1, at, half, gray(1 + noise_of_samples * normal(&rng)));
      noise[point] = regression.along[point] * regression.along[point];
      from.push_back(at);
      to.push_back((found[0] + found[1]) * 0.5f);
    }
  }
  WayRegression plain = regression;
  const auto share = static_cast<float>(regression.expected_share(noise));
  regression.spread(window_means);
  plain.spread(window_means);
  noise = window_means(std::move(noise));
  double without = 0, with = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    regression.shrink(i, share, noise[i] / kPoints);
    without += std::pow(double{plain.draw(i, from[i], to[i]).x} - 1, 2);
    with += std::pow(double{regression.draw(i, from[i], to[i]).x} - 1, 2);
  }
  const auto count = static_cast<double>(from.size());
  return {std::sqrt(without / count), std::sqrt(with / count)};
}

TEST(WayRegression, NoiseDoesNotDrawAwayFromWhatIsAboutRight) {
  const auto [without, with] = errors(0, 0.03f, 3);
  EXPECT_LT(with, 0.75 * without);
}

TEST(WayRegression, WhatIsWrongIsDrawnToThePaths) {
  const auto [without, with] = errors(0.5f, 0.1f, 1);
  EXPECT_LT(without, 0.2);
  EXPECT_LT(with, 1.02 * without);
  EXPECT_LT(errors(0.5f, 0.1f, 20).second, 0.25) << "all windows together know it";
}

TEST(WayRegression, WithoutAWayNoneIsTaken) {
  WayRegression regression(2);
  regression.add(0, 1, gray(1), gray(1), gray(3));
  const auto share = static_cast<float>(regression.expected_share({0, 0}));
  EXPECT_EQ(share, 0);
  regression.shrink(0, share, 0);
  EXPECT_EQ(regression.draw(0, gray(1), gray(1)).x, 1);
}

}  // namespace
}  // namespace lte::render
