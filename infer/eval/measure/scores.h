// The errors of one prediction, and their mean and median over scenes. docs/metrics.md has the
// formulas.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lte/base/math.h"
#include "lte/image/image.h"

namespace lte::infer {

/// What could not be measured.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

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

/// The factor that brings the 99th percentile of the reference's luminance to 1, so that few bright
/// pixels do not darken the rest; 1 for a black reference.
double white_exposure(std::span<const Rgb> reference);

/// Scores irradiance over the emission scalar at points.
PointScore score_points(std::span<const Rgb> prediction, std::span<const Rgb> reference);

/// Scores one view. Values are of the pixels whose mask is set, in row order.
/// @param seen  the reference that SSIM and FLIP compare with: `reference`, or that without its
///              noise, which rules both where a pixel has some hundred paths
ViewScore score_view(std::span<const Rgb> prediction, std::span<const Rgb> reference,
                     std::span<const Rgb> seen, std::span<const uint8_t> mask, int width,
                     int height);

/// Puts the values of the masked pixels back into a picture, which is black elsewhere.
image::Image fill_mask(std::span<const Rgb> values, std::span<const uint8_t> mask, int width,
                       int height);

double mean_of(std::span<const double> values);
/// The middle value, or the mean of the two middle ones; NaN of nothing.
double median_of(std::vector<double> values);

/// Mean and median over scenes, each figure by itself, of the predictors that every scene has. NaN
/// entries are left out.
Scores mean_scores(const std::vector<Scores>& scenes);
Scores median_scores(const std::vector<Scores>& scenes);

}  // namespace lte::infer
