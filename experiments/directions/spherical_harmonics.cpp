#include "experiments/directions/spherical_harmonics.h"

#include <cmath>
#include <numbers>

#include <ATen/ATen.h>

namespace lte::experiments {
namespace {

/// P_lm without the Condon-Shortley phase, normalized so that its square, with the azimuth's,
/// integrates to one over the sphere; for m ≥ 0 at l (l + 1) / 2 + m. Recurrences of Numerical
/// Recipes 6.7, which are stable upwards in l.
std::vector<double> normalized_legendre(int degree, double z) {
  std::vector<double> P(static_cast<size_t>((degree + 1) * (degree + 2) / 2));
  const auto at = [](int l, int m) { return static_cast<size_t>(l * (l + 1) / 2 + m); };
  const double s = std::sqrt(std::max(0.0, 1 - z * z));
  P[0] = std::sqrt(1 / (4 * std::numbers::pi));
  for (int m = 1; m <= degree; ++m)
    P[at(m, m)] = P[at(m - 1, m - 1)] * s * std::sqrt((2 * m + 1.0) / (2.0 * m));
  for (int m = 0; m < degree; ++m) P[at(m + 1, m)] = z * std::sqrt(2 * m + 3.0) * P[at(m, m)];
  for (int m = 0; m <= degree; ++m) {
    for (int l = m + 2; l <= degree; ++l) {
      const double a = std::sqrt((4.0 * l * l - 1) / (double{1} * l * l - double{1} * m * m));
      const double before = std::sqrt((double{1} * (l - 1) * (l - 1) - double{1} * m * m) /
                                      (4.0 * (l - 1) * (l - 1) - 1));
      P[at(l, m)] = a * (z * P[at(l - 1, m)] - before * P[at(l - 2, m)]);
    }
  }
  return P;
}

/// [cells, (degree + 1)²] float64.
at::Tensor basis_of(int degree, std::span<const Vec3> directions) {
  const int64_t count = int64_t{degree + 1} * (degree + 1);
  at::Tensor basis = at::empty({static_cast<int64_t>(directions.size()), count}, at::kDouble);
  auto* out = basis.data_ptr<double>();
  for (const Vec3& direction : directions)
    out = std::copy_n(spherical_harmonics(degree, direction).begin(), count, out);
  return basis;
}

/// [(degree + 1)²]: the factor on each coefficient.
at::Tensor lanczos_window(int degree) {
  at::Tensor window = at::ones({int64_t{degree + 1} * (degree + 1)}, at::kDouble);
  auto* w = window.data_ptr<double>();
  for (int l = 1; l <= degree; ++l) {
    const double x = std::numbers::pi * l / (degree + 1);
    for (int m = -l; m <= l; ++m) w[l * (l + 1) + m] = std::sin(x) / x;
  }
  return window;
}

}  // namespace

std::vector<double> spherical_harmonics(int degree, const Vec3& direction) {
  const std::vector<double> P = normalized_legendre(degree, double{direction.z});
  const double azimuth = std::atan2(double{direction.y}, double{direction.x});
  std::vector<double> Y(static_cast<size_t>((degree + 1) * (degree + 1)));
  for (int l = 0; l <= degree; ++l) {
    const auto middle = static_cast<size_t>(l * (l + 1));
    Y[middle] = P[middle / 2];
    for (int m = 1; m <= l; ++m) {
      const double p = std::numbers::sqrt2 * P[middle / 2 + static_cast<size_t>(m)];
      Y[middle + static_cast<size_t>(m)] = p * std::cos(m * azimuth);
      Y[middle - static_cast<size_t>(m)] = p * std::sin(m * azimuth);
    }
  }
  return Y;
}

HarmonicFitter::HarmonicFitter(int degree, HarmonicFit fit, std::span<const Vec3> directions,
                               std::span<const double> solid_angle)
    : basis_(basis_of(degree, directions)) {
  // Cells have equal projected solid angle: plain least squares over them is that under the cosine.
  if (fit == HarmonicFit::LeastSquares) {
    analysis_ = at::linalg_pinv(basis_);
    return;
  }
  const at::Tensor area =
      at::from_blob(const_cast<double*>(solid_angle.data()),
                    {static_cast<int64_t>(solid_angle.size())}, at::TensorOptions(at::kDouble));
  analysis_ = basis_.t() * area;
  if (fit == HarmonicFit::Windowed) analysis_ = lanczos_window(degree).unsqueeze(1) * analysis_;
}

}  // namespace lte::experiments
