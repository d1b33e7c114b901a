// Errors of irradiance at points against two independent references, without their noise.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::experiments {

/// Indirect irradiance, W/m², an entry a point; the three are independent.
struct PointReferences {
  std::vector<Rgb> a, b;
  std::vector<Rgb> few;  ///< by kFewPaths paths: the unit of PointErrors::worth()
};
inline constexpr int kFewPaths = 64;

/// Values count as 4 times the 99.9 % quantile of (A + B)/2 at most, as infer/eval/measure's
/// pair_error() has it.
class PointErrors {
 public:
  /// @throws lte::Error if sizes differ or the references are black
  explicit PointErrors(const PointReferences& references);

  /// Mean over points and channels of (x - A)(x - B): the squared error of x.
  double mse(std::span<const Rgb> x) const { return product(x, x); }
  /// The same of two estimates x and y of independent noise: what is wrong with both, their bias.
  double product(std::span<const Rgb> x, std::span<const Rgb> y) const;
  double mean_ratio(std::span<const Rgb> x) const;
  /// Equal-error paths a point of a squared error: kFewPaths times the error of so many over it.
  double worth(double mse) const { return kFewPaths * few_mse_ / mse; }
  double mean() const { return mean_; }
  float cap() const { return cap_; }

 private:
  double capped(float value) const { return double{std::min(value, cap_)}; }

  const PointReferences& references_;
  float cap_ = 0;
  double mean_ = 0, few_mse_ = 0;
};

}  // namespace lte::experiments
