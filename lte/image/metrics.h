// Error metrics on linear values. docs/metrics.md has the formulas and the reasons.
#pragma once

#include <cstdint>
#include <span>

#include "lte/image/image.h"

namespace lte::image {

/// Mean over all values of (a − b)².
double mse(std::span<const float> a, std::span<const float> reference);

/// 10 log10(peak² / MSE) in dB, capped at 100 dB. `peak` is the value called white.
double psnr(double mse, double peak);

/// Mean over values of (a − b)² / (b² + epsilon), the relative MSE of rendering papers.
double relative_mse(std::span<const float> a, std::span<const float> reference,
                    double epsilon = 1e-2);

/// Mean of ((log(a + 1) − log(b + 1)) / (log(b + 1) + epsilon))²: the training loss with the
/// reference in the denominator, so that it is the same for every method compared. Negative values
/// count as zero.
double log_relative_l2(std::span<const float> a, std::span<const float> reference,
                       double epsilon = 1e-2);

/// Structural similarity (Wang et al. 2004) of display values in [0, 1]: an 11 × 11 Gaussian window
/// of σ = 1.5, K1 = 0.01, K2 = 0.03, data range 1. It is the mean over channels and over those
/// pixels whose whole window lies inside the picture.
/// @param mask  if not empty, [height, width]: only pixels with a non-zero entry are averaged; 1 if
/// there are none
/// @throws lte::Error if sizes differ or a side is under 11 pixels.
double ssim(const Image& a, const Image& reference, std::span<const uint8_t> mask = {});

}  // namespace lte::image
