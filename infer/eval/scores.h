// Error figures of one prediction, and how those of many scenes are put together. docs/metrics.md
// has the formulas.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lte/base/math.h"
#include "lte/image/image.h"

namespace lte::infer {

inline constexpr std::array<const char*, 4> kPointMetrics = {"mse", "psnr", "relmse", "logrel"};
inline constexpr std::array<const char*, 6> kViewMetrics = {"mse",    "psnr", "ssim",
                                                            "relmse", "flip", "hdrflip"};
/// In the order of the names above.
using PointScore = std::array<double, kPointMetrics.size()>;
using ViewScore = std::array<double, kViewMetrics.size()>;

/// NaN where there was nothing to measure.
struct Score {
  PointScore points;
  ViewScore views;
  Score();
};

/// The scores of each predictor, in order of display.
using Scores = std::vector<std::pair<std::string, Score>>;

/// The score of a predictor; null if there is none of that name.
const Score* find_score(const Scores& scores, const std::string& name);

/// Brings the 99th percentile of the reference's luminance to 1, so that white is the brightest of
/// what matters; 1 for a black reference.
double white_exposure(std::span<const Rgb> reference);

/// Irradiance over the emission scalar, at points.
PointScore score_points(std::span<const Rgb> prediction, std::span<const Rgb> reference);

/// One view: values of the pixels whose mask is set, in row order.
ViewScore score_view(std::span<const Rgb> prediction, std::span<const Rgb> reference,
                     std::span<const uint8_t> mask, int width, int height);

/// Values of the masked pixels put back into a picture that is black elsewhere.
image::Image fill_mask(std::span<const Rgb> values, std::span<const uint8_t> mask, int width,
                       int height);

double mean_of(std::span<const double> values);
/// The middle value, or the mean of the two middle ones; NaN of nothing.
double median_of(std::vector<double> values);

/// Over scenes, each figure by itself; NaN entries are left out. Only predictors that every scene
/// has.
Scores mean_scores(const std::vector<Scores>& scenes);
Scores median_scores(const std::vector<Scores>& scenes);

}  // namespace lte::infer
