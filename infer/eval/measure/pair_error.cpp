#include "infer/eval/measure/pair_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr double kCapQuantile = 0.999, kCapFactor = 4;
/// Standard errors above a non-positive error within which the true one lies, nearly always.
constexpr double kBoundErrors = 2;

bool counts(std::span<const uint8_t> mask, size_t pixel) {
  return mask.empty() || mask[pixel] != 0;
}

/// Four times the quantile; infinite where that is 0.
float cap_of(const Image& a, const Image& b, std::span<const uint8_t> mask) {
  std::vector<float> values;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    if (counts(mask, k / 3)) values.push_back(0.5F * (a.pixels[k] + b.pixels[k]));
  }
  if (values.empty()) return std::numeric_limits<float>::infinity();
  const auto at = static_cast<ptrdiff_t>(kCapQuantile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  const float quantile = values[static_cast<size_t>(at)];
  return quantile > 0 ? static_cast<float>(kCapFactor) * quantile
                      : std::numeric_limits<float>::infinity();
}

/// Sums over what counts in a block.
struct Block {
  double pixels = 0;
  double product = 0;  // of pixels
  double x[3] = {}, a[3] = {}, b[3] = {};

  /// Of means, summed over channels.
  double product_of_means() const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += (x[c] - a[c]) * (x[c] - b[c]);
    return sum / (pixels * pixels);
  }
};

/// Sums over what counts in the picture.
struct Sums {
  double picture = 0, reference = 0, noise = 0;
  std::vector<Block> blocks;
};

Sums sums_of(const Image& picture, const Image& a, const Image& b, std::span<const uint8_t> mask,
             float cap) {
  const int columns = (picture.width + kErrorBlock - 1) / kErrorBlock;
  const int rows = (picture.height + kErrorBlock - 1) / kErrorBlock;
  Sums sums;
  sums.blocks.resize(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const size_t pixel = picture.number(x, y);
      if (!counts(mask, pixel)) continue;
      Block& block = sums.blocks[static_cast<size_t>(y / kErrorBlock * columns + x / kErrorBlock)];
      block.pixels += 1;
      for (size_t c = 0; c < 3; ++c) {
        const auto capped = [&](const Image& image) {
          return double{std::min(image.pixels[3 * pixel + c], cap)};
        };
        const double value = capped(picture), first = capped(a), second = capped(b);
        sums.picture += value;
        sums.reference += 0.5 * (first + second);
        sums.noise += (first - second) * (first - second);
        block.product += (value - first) * (value - second);
        block.x[c] += value;
        block.a[c] += first;
        block.b[c] += second;
      }
    }
  }
  std::erase_if(sums.blocks, [](const Block& block) { return block.pixels == 0; });
  return sums;
}

/// Of a mean over blocks of unlike sizes.
double standard_error(const std::vector<Block>& blocks, double mse, double pixels) {
  if (blocks.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0;
  for (const Block& block : blocks) {
    const double rest = block.product - 3 * block.pixels * mse;
    squares += rest * rest;
  }
  const auto count = static_cast<double>(blocks.size());
  return std::sqrt(squares * count / (count - 1)) / (3 * pixels);
}

}  // namespace

bool PairError::is_right() const {
  if (!measured()) return false;
  return std::abs(mean_ratio - 1) <= kRightMean && block_error <= kRightBlocks &&
         (path_variance <= 0 || worth >= kRightWorth);
}

PairError pair_error(const Image& picture, const Image& a, const Image& b,
                     std::span<const uint8_t> mask, int paths) {
  LTE_CHECK(picture.channels == 3 && picture.pixels.size() == a.pixels.size() &&
                a.pixels.size() == b.pixels.size() && picture.width == a.width &&
                a.width == b.width && (mask.empty() || 3 * mask.size() == a.pixels.size()),
            "pair error: pictures of different sizes");
  // It would pass for an error below the reference's noise.
  const auto odd = std::ranges::find_if(picture.pixels, [](float v) { return std::isnan(v); });
  const auto pixel = (odd - picture.pixels.begin()) / 3;
  LTE_CHECK(odd == picture.pixels.end(), "pair error: pixel ", pixel % picture.width, ", ",
            pixel / picture.width, " of the picture is not a number");
  const float cap = cap_of(a, b, mask);
  const Sums sums = sums_of(picture, a, b, mask, cap);
  PairError out;
  out.cap = double{cap};
  double pixels = 0, products = 0, block_products = 0;
  for (const Block& block : sums.blocks) {
    pixels += block.pixels;
    products += block.product;
    block_products += block.pixels * block.product_of_means();
  }
  out.pixels = static_cast<int64_t>(pixels);
  out.mean = pixels > 0 ? sums.reference / (3 * pixels) : 0;
  if (!out.measured()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    out.mean_ratio = out.mse = out.mse_stderr = out.block_error = out.path_variance = out.worth =
        nan;
    return out;
  }
  out.mean_ratio = sums.picture / sums.reference;
  out.mse = products / (3 * pixels);
  out.mse_stderr = standard_error(sums.blocks, out.mse, pixels);
  out.block_error = std::sqrt(std::max(block_products / (3 * pixels), 0.0)) / out.mean;
  out.path_variance = paths * sums.noise / (3 * pixels) / 2;
  out.below_noise = !(out.mse > 0);
  out.worth = out.path_variance / (out.below_noise ? kBoundErrors * out.mse_stderr : out.mse);
  return out;
}

}  // namespace lte::infer
