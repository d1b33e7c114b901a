// Error of a picture x against two independent references A and B of n paths a pixel each, without
// their noise: the mean of (x - A)(x - B), as E[A] = E[B] is the truth and their errors are
// independent of one another and of x. docs/metrics.md has the definitions.
#pragma once

#include <cstdint>
#include <span>

#include "lte/image/image.h"

namespace lte::infer {

/// Edge of a block, in pixels.
inline constexpr int kErrorBlock = 8;

/// What a method has to reach to be right in a scene.
inline constexpr double kRightMean = 0.05, kRightBlocks = 0.10, kRightWorth = 64;

/// Figures over pixels and the three channels. NaN where the reference is dark all over.
struct PairError {
  int64_t pixels = 0;        ///< that count
  double mean = 0;           ///< of the reference, (A + B)/2
  double mean_ratio = 0;     ///< mean of x over that
  double mse = 0;            ///< without noise; may come out below 0
  double mse_stderr = 0;     ///< of `mse`, by the spread over blocks
  double block_error = 0;    ///< root of the same product of block means, over the mean; 0 below 0
  double path_variance = 0;  ///< of one path a pixel: n times half the mean of (A - B)²
  double worth = 0;          ///< paths a pixel of equal error: path_variance / mse
  bool below_noise = false;  ///< mse is not above 0: `worth` is what it is at least
  double cap = 0;            ///< larger values of x, A and B count as this; infinite: none does

  bool measured() const { return mean > 0; }
  /// Mean within 5 %, blocks within 10 %, worth at least 64 paths; a scene whose paths do not vary
  /// has no worth, and the first two decide.
  bool is_right() const;
};

/// Fireflies, which rule means of squares, are capped: values of x, A and B count as 4 times the
/// 99.9 % quantile of (A + B)/2 at most, over the pixels and channels that count.
/// @param picture, a, b  [height, width, 3]
/// @param mask           [height * width]: pixels with a non-zero entry count; empty: all
/// @param paths          n
/// @throws lte::Error if sizes differ or a value of the picture is not a number
PairError pair_error(const image::Image& picture, const image::Image& a, const image::Image& b,
                     std::span<const uint8_t> mask, int paths);

}  // namespace lte::infer
