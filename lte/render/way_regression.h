// How far the way from one estimate of light to another goes towards the truth.
//
// Samples whose noise the two estimates do not share tell it without bias: the share of the way is
// that of least squared error (linear regression) over a point's surroundings.
#pragma once

#include <algorithm>
#include <vector>

#include "lte/base/math.h"

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
  /// Draws less where noise may have made the share: by one less the ratio of noise to what was
  /// found (James and Stein's positive part), nothing where that is not positive.
  /// @param noise  variance of `along`
  void shrink(size_t point, float noise) {
    const float found = along[point];
    along[point] = found > 0 && found * found > noise ? found - noise / found : 0;
  }
  /// `from` drawn towards `to`; never below 0.
  Rgb draw(size_t point, const Rgb& from, const Rgb& to) const {
    if (!(square[point] > 0)) return from;
    const float share = std::clamp(along[point] / square[point], 0.0f, 1.0f);
    return max(Rgb{}, from + share * (to - from));
  }
};

}  // namespace lte::render
