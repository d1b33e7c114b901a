#include "experiments/gathered_base/point_errors.h"

#include <algorithm>
#include <limits>

#include "lte/base/check.h"

namespace lte::experiments {
namespace {

constexpr double kCapQuantile = 0.999;
constexpr float kCapFactor = 4;

float cap_of(const PointReferences& references) {
  std::vector<float> values;
  for (size_t i = 0; i < references.a.size(); ++i) {
    for (int c = 0; c < 3; ++c) values.push_back(0.5f * (references.a[i][c] + references.b[i][c]));
  }
  const auto at = static_cast<ptrdiff_t>(kCapQuantile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  const float quantile = values[static_cast<size_t>(at)];
  return quantile > 0 ? kCapFactor * quantile : std::numeric_limits<float>::infinity();
}

}  // namespace

PointErrors::PointErrors(const PointReferences& references) : references_(references) {
  LTE_CHECK(!references.a.empty() && references.a.size() == references.b.size() &&
                references.a.size() == references.few.size(),
            "references: expected as many points in each, and one at least");
  cap_ = cap_of(references);
  for (size_t i = 0; i < references.a.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      mean_ += 0.5 * (capped(references.a[i][c]) + capped(references.b[i][c]));
  }
  mean_ /= 3 * static_cast<double>(references.a.size());
  LTE_CHECK(mean_ > 0, "references: no indirect light arrives at the points");
  few_mse_ = mse(references.few);
}

double PointErrors::product(std::span<const Rgb> x, std::span<const Rgb> y) const {
  LTE_CHECK(x.size() == references_.a.size() && y.size() == x.size(), "expected ",
            references_.a.size(), " answers, got ", x.size(), " and ", y.size());
  double sum = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double a = capped(references_.a[i][c]), b = capped(references_.b[i][c]),
                   first = capped(x[i][c]), second = capped(y[i][c]);
      sum += 0.5 * ((first - a) * (second - b) + (second - a) * (first - b));
    }
  }
  return sum / (3 * static_cast<double>(x.size()));
}

double PointErrors::mean_ratio(std::span<const Rgb> x) const {
  double sum = 0;
  for (const Rgb& value : x) {
    for (int c = 0; c < 3; ++c) sum += capped(value[c]);
  }
  return sum / (3 * static_cast<double>(x.size()) * mean_);
}

}  // namespace lte::experiments
