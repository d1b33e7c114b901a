// How far the way from one estimate of light to another goes towards the truth.
//
// Samples whose noise the two estimates do not share tell it without bias: the share of the way is
// that of least squared error (linear regression) over a point's surroundings.
#pragma once

#include <algorithm>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/expected_error.h"

namespace lte::render {

/// One over the light of each point: errors count relative to it. What is darker than a tenth of
/// the mean counts like that.
/// @param light  luminance
std::vector<float> error_weights(std::vector<float> light);

/// Sums of the regression, an entry a point.
struct WayRegression {
  std::vector<float> along, square;

  explicit WayRegression(size_t points) : along(points), square(points) {}

  /// @param weight  error_weights()
  void add(size_t point, float weight, const Rgb& from, const Rgb& to, const Rgb& sample) {
    const Rgb way = (to - from) * weight;
    along[point] += dot(way, (sample - from) * weight);
    square[point] += dot(way, way);
  }
  /// Sums over the surroundings of each point in the place of its own.
  /// @param mean  of a value a point: their means
  template <typename Mean>
  void spread(const Mean& mean) {
    along = mean(std::move(along));
    square = mean(std::move(square));
  }
  /// The share that all points together expect, before spread(): over the square of the way, what
  /// `from` is off by, as all samples tell it, drawn towards gi::kSharedError (gi::shrunk()).
  /// @param noise  variance of each point's `along`
  double expected_share(const std::vector<float>& noise) const;
  /// Draws the share towards the one expected where noise may have made it (gi::shrunk()).
  /// @param noise  variance of `along`
  void shrink(size_t point, float share, float noise) {
    along[point] = static_cast<float>(gi::shrunk(along[point], noise, share * square[point]));
  }
  /// `from` drawn towards `to`; never below 0.
  Rgb draw(size_t point, const Rgb& from, const Rgb& to) const {
    if (!(square[point] > 0)) return from;
    const float share = std::clamp(along[point] / square[point], 0.0f, 1.0f);
    return max(Rgb{}, from + share * (to - from));
  }
};

}  // namespace lte::render
