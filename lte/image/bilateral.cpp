#include "lte/image/bilateral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::image {
namespace {

constexpr int kRowsAtOnce = 8;
/// Cosine of the largest angle between normals that are mixed, 18°.
constexpr float kMinCosine = 0.95f;
/// Sine of the largest angle under which a point may stand above the other's plane, 6°.
constexpr float kLargestSlope = 0.1f;
/// The B3 spline.
constexpr std::array<float, 5> kTaps{1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};
/// Pixels to each side from which variance is estimated where it is not known.
constexpr int kVarianceRadius = 3;

/// Values of one pass: color, and the variance of its luminance.
struct Plane {
  std::vector<Rgb> color;
  std::vector<float> variance;
};

/// Whether the filter may mix two surface points.
bool same_surface(const Vec3& position_a, const Vec3& normal_a, const Vec3& position_b,
                  const Vec3& normal_b) {
  if (!(dot(normal_a, normal_b) >= kMinCosine)) return false;
  const Vec3 between = position_b - position_a;
  const float above_a = dot(between, normal_a), above_b = dot(between, normal_b);
  const float limit = kLargestSlope * kLargestSlope * dot(between, between);
  return above_a * above_a <= limit && above_b * above_b <= limit;
}

class Filter {
 public:
  Filter(const Image& noisy, const BilateralGuides& guides, const BilateralOptions& options)
      : width_(noisy.width), height_(noisy.height), options_(options) {
    const size_t count = static_cast<size_t>(width_) * static_cast<size_t>(height_);
    now_.color.resize(count);
    now_.variance.assign(count, 0.0f);
    next_ = now_;
    position_.resize(count);
    normal_.resize(count);
    for (size_t i = 0; i < count; ++i) {
      now_.color[i] = noisy.rgb(i);
      position_[i] = guides.position->rgb(i);
      normal_[i] = guides.normal->rgb(i);
    }
    find_variance(guides.variance);
  }

  Image run() {
    for (int pass = 0; pass < options_.passes; ++pass) {
      each_pixel([&](int x, int y, size_t i) { filter(x, y, i, 1 << pass); });
      std::swap(now_, next_);
    }
    Image out(width_, height_, 3);
    for (size_t i = 0; i < now_.color.size(); ++i) out.set_rgb(i, now_.color[i]);
    return out;
  }

 private:
  template <typename Body>
  void each_pixel(const Body& body) {
    parallel_for(height_, kRowsAtOnce, [&](int64_t begin, int64_t end) {
      for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
        for (int x = 0; x < width_; ++x) body(x, y, index(x, y));
      }
    });
  }

  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  bool inside(int x, int y) const { return x >= 0 && x < width_ && y >= 0 && y < height_; }
  bool background(size_t i) const { return !(dot(normal_[i], normal_[i]) > 0); }
  bool mixes(size_t i, size_t j) const {
    return same_surface(position_[i], normal_[i], position_[j], normal_[j]);
  }

  void find_variance(const Image* known) {
    each_pixel([&](int x, int y, size_t i) {
      if (background(i)) return;
      const float given =
          known != nullptr ? known->pixels[i] : std::numeric_limits<float>::infinity();
      now_.variance[i] = std::isfinite(given) ? given : spread_around(x, y, i);
    });
  }

  /// Unbiased variance of luminance over the neighbours on the same surface.
  float spread_around(int x, int y, size_t i) const {
    double sum = 0, squares = 0;
    int count = 0;
    for (int dy = -kVarianceRadius; dy <= kVarianceRadius; ++dy) {
      for (int dx = -kVarianceRadius; dx <= kVarianceRadius; ++dx) {
        if (!inside(x + dx, y + dy) || !mixes(i, index(x + dx, y + dy))) continue;
        const double value = luminance(now_.color[index(x + dx, y + dy)]);
        sum += value;
        squares += value * value;
        ++count;
      }
    }
    if (count < 2) return 0;
    return static_cast<float>(std::max(0.0, squares - sum * sum / count) / (count - 1));
  }

  /// Mean variance of the neighbours: that of a single pixel is too uncertain to weigh by.
  float variance_around(int x, int y, size_t i) const {
    constexpr std::array<float, 3> kWeights{0.25f, 0.5f, 0.25f};
    float sum = 0, weights = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!inside(x + dx, y + dy) || !mixes(i, index(x + dx, y + dy))) continue;
        const float weight =
            kWeights[static_cast<size_t>(dx + 1)] * kWeights[static_cast<size_t>(dy + 1)];
        sum += weight * now_.variance[index(x + dx, y + dy)];
        weights += weight;
      }
    }
    return weights > 0 ? sum / weights : 0;
  }

  void filter(int x, int y, size_t i, int step) {
    next_.color[i] = now_.color[i];
    next_.variance[i] = now_.variance[i];
    if (background(i)) return;
    const float own = luminance(now_.color[i]);
    const float error = options_.luminance_sigma * std::sqrt(variance_around(x, y, i));
    const float scale = 1 / (error + 1e-6f * std::fabs(own) + std::numeric_limits<float>::min());
    Rgb sum;
    float weights = 0, variance = 0;
    for (int row = -2; row <= 2; ++row) {
      for (int column = -2; column <= 2; ++column) {
        const int tap_x = x + column * step, tap_y = y + row * step;
        if (!inside(tap_x, tap_y)) continue;
        const size_t j = index(tap_x, tap_y);
        if (j != i && !mixes(i, j)) continue;
        float weight = kTaps[static_cast<size_t>(column + 2)] * kTaps[static_cast<size_t>(row + 2)];
        weight *= std::exp(-std::fabs(luminance(now_.color[j]) - own) * scale);
        sum += now_.color[j] * weight;
        weights += weight;
        variance += weight * weight * now_.variance[j];
      }
    }
    next_.color[i] = sum * (1 / weights);  // its own tap always counts
    next_.variance[i] = variance / (weights * weights);
  }

  const int width_, height_;
  const BilateralOptions& options_;
  std::vector<Vec3> position_, normal_;
  Plane now_, next_;
};

}  // namespace

Image bilateral_filter(const Image& noisy, const BilateralGuides& guides,
                       const BilateralOptions& options) {
  const auto check = [&](const Image* image, int channels, const char* what) {
    LTE_CHECK(image != nullptr, "the bilateral filter needs ", what);
    LTE_CHECK(
        image->channels == channels && image->width == noisy.width && image->height == noisy.height,
        what, " of ", image->width, "x", image->height, "x", image->channels, ": expected ",
        noisy.width, "x", noisy.height, "x", channels);
  };
  check(&noisy, 3, "a picture");
  check(guides.normal, 3, "normals");
  check(guides.position, 3, "positions");
  if (guides.variance != nullptr) check(guides.variance, 1, "variances");
  LTE_CHECK(options.passes >= 0 && options.passes <= 12, "passes must be 0 to 12, got ",
            options.passes);
  LTE_CHECK(options.luminance_sigma > 0 && std::isfinite(options.luminance_sigma),
            "luminance_sigma must be positive and finite, got ", options.luminance_sigma);
  return Filter(noisy, guides, options).run();
}

}  // namespace lte::image
