#include "infer/renderer/path_correction.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/image/bilateral.h"

namespace lte::infer {
namespace {

using image::Image;

// Passes of the filter beyond which no correction is smoothed: 5 reach 62 pixels to each side.
constexpr int kPasses = 5;
// Half an edge of the square over which errors are estimated, and of that over which choices are
// blended.
constexpr int kWindow = 8, kBlend = 3;
constexpr int kRowsAtOnce = 8;

/// Means over squares around each pixel, of the pixels in the mask.
class BoxMean {
 public:
  BoxMean(int width, int height, std::span<const uint8_t> mask)
      : width_(width), height_(height), mask_(mask) {}

  std::vector<float> operator()(const std::vector<float>& values, int radius) const {
    std::vector<double> sums(values.size()), weights(values.size());
    each_row(height_, [&](int y) {
      const size_t row = at(0, y);
      double sum = 0, weight = 0;
      for (int x = -radius; x < width_; ++x) {
        if (x + radius < width_) add(values, at(x + radius, y), 1, &sum, &weight);
        if (x - radius > 0) add(values, at(x - radius - 1, y), -1, &sum, &weight);
        if (x < 0) continue;
        sums[row + static_cast<size_t>(x)] = sum;
        weights[row + static_cast<size_t>(x)] = weight;
      }
    });
    std::vector<float> out(values.size());
    each_row(height_, [&](int y) {
      const int first = std::max(0, y - radius), last = std::min(height_ - 1, y + radius);
      for (int x = 0; x < width_; ++x) {
        double sum = 0, weight = 0;
        for (int row = first; row <= last; ++row) {
          sum += sums[at(x, row)];
          weight += weights[at(x, row)];
        }
        out[at(x, y)] = weight > 0.5 ? static_cast<float>(sum / weight) : 0;
      }
    });
    return out;
  }

  template <typename Body>
  static void each_row(int height, const Body& body) {
    parallel_for(height, kRowsAtOnce, [&](int64_t begin, int64_t end) {
      for (int64_t y = begin; y < end; ++y) body(static_cast<int>(y));
    });
  }

 private:
  size_t at(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  void add(const std::vector<float>& values, size_t i, double sign, double* sum,
           double* weight) const {
    if (!mask_[i]) return;
    *sum += sign * static_cast<double>(values[i]);
    *weight += sign;
  }

  int width_, height_;
  std::span<const uint8_t> mask_;
};

Image difference(const Image& a, const Image& b) {
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] -= b.pixels[i];
  return out;
}

/// The half's corrections, smoothed more from step to step.
struct Halves {
  Image a, b;
};

/// The error that the answer keeps with corrections of this width, by its estimate: squared bias by
/// the product of what either half has lost, which has none of their noise in its mean; and the
/// variance of the mean of both.
std::vector<float> risk(const Halves& raw, const Halves& smooth, const BoxMean& mean) {
  const size_t count = raw.a.pixels.size() / 3;
  std::vector<float> bias(count), variance(count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      bias[i] += (smooth.a.pixels[k] - raw.a.pixels[k]) * (smooth.b.pixels[k] - raw.b.pixels[k]);
      const float apart = smooth.a.pixels[k] - smooth.b.pixels[k];
      variance[i] += apart * apart / 4;
    }
  }
  bias = mean(bias, kWindow);
  variance = mean(variance, kWindow);
  for (size_t i = 0; i < count; ++i) bias[i] = std::max(0.0f, bias[i]) + variance[i];
  return bias;
}

}  // namespace

Image correct_by_paths(const SurfaceGuides& guides, std::span<const uint8_t> mask,
                       const Image& answer, const Image& half_a, const Image& half_b,
                       const std::function<void()>& check) {
  const auto is_of_size = [&](const Image& image) {
    return image.width == guides.width() && image.height == guides.height() && image.channels == 3;
  };
  LTE_CHECK(is_of_size(answer) && is_of_size(half_a) && is_of_size(half_b) &&
                mask.size() == guides.pixels(),
            "correction by paths: pictures of different sizes");
  const size_t count = guides.pixels();
  const BoxMean mean(guides.width(), guides.height(), mask);
  Image normal = guides.normal;  // the filter is to mix nothing from outside of the mask
  for (size_t i = 0; i < count; ++i) {
    if (!mask[i]) std::fill_n(normal.pixels.begin() + static_cast<int64_t>(3 * i), 3, 0.0f);
  }
  const Halves raw{difference(half_a, answer), difference(half_b, answer)};
  // No correction at all is the widest smoothing: it loses everything and has no noise.
  const Image nothing(guides.width(), guides.height(), 3);
  std::vector<float> least = risk(raw, {nothing, nothing}, mean);
  std::vector<int8_t> best(count, -1);
  std::array<Image, kPasses + 1> corrections;
  Halves smooth = raw;
  for (int pass = 0; pass <= kPasses; ++pass) {
    if (check) check();
    if (pass > 0) {
      const image::BilateralGuides by{&normal, &guides.position, nullptr};
      const image::BilateralOptions once{.passes = 1,
                                         .luminance_sigma = std::numeric_limits<float>::infinity(),
                                         .first_pass = pass - 1};
      smooth.a = image::bilateral_filter(smooth.a, by, once);
      if (check) check();
      smooth.b = image::bilateral_filter(smooth.b, by, once);
    }
    const std::vector<float> now = risk(raw, smooth, mean);
    Image& correction = corrections[static_cast<size_t>(pass)];
    correction = smooth.a;
    for (size_t k = 0; k < correction.pixels.size(); ++k)
      correction.pixels[k] = (correction.pixels[k] + smooth.b.pixels[k]) / 2;
    for (size_t i = 0; i < count; ++i) {
      if (!(now[i] < least[i])) continue;
      least[i] = now[i];
      best[i] = static_cast<int8_t>(pass);
    }
  }
  Image out = answer;
  std::vector<float> chosen(count);
  for (int pass = 0; pass <= kPasses; ++pass) {
    for (size_t i = 0; i < count; ++i) chosen[i] = best[i] == pass ? 1 : 0;
    const std::vector<float> share = mean(chosen, kBlend);
    const Image& correction = corrections[static_cast<size_t>(pass)];
    for (size_t i = 0; i < count; ++i) {
      if (!mask[i]) continue;
      for (size_t k = 3 * i; k < 3 * i + 3; ++k) out.pixels[k] += share[i] * correction.pixels[k];
    }
  }
  // A corrected value below 0 is noise. Where that happens the paths' own mean is none, so this
  // keeps what they converge to.
  for (float& value : out.pixels) value = std::max(value, 0.0f);
  return out;
}

}  // namespace lte::infer
