// Internal: least squares by conjugate gradients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lte::bake {

inline constexpr int kIterations = 60;
inline constexpr double kPrecision = 1e-5;

inline double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Conjugate gradients from `x`, which becomes the solution; the diagonal preconditions.
/// @param system  has `diagonal` and times(x), of normal equations
/// @param fixed   [unknowns] not 0: stays as it is
template <typename System>
void solve(const System& system, const std::vector<double>& right,
           const std::vector<uint8_t>& fixed, std::vector<double>* x) {
  const auto scaled = [&](std::vector<double> values) {
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = fixed[i] != 0 ? 0 : values[i] / system.diagonal[i];
    return values;
  };
  std::vector<double> residual = system.times(*x);
  for (size_t i = 0; i < residual.size(); ++i) residual[i] = right[i] - residual[i];
  std::vector<double> direction = scaled(residual);
  double square = product(residual, direction);
  const double least = kPrecision * product(right, scaled(right));
  for (int k = 0; k < kIterations && square > least; ++k) {
    const std::vector<double> image = system.times(direction);
    const double step = square / product(direction, image);
    for (size_t i = 0; i < x->size(); ++i) {
      (*x)[i] += step * direction[i];
      residual[i] -= step * image[i];
    }
    const std::vector<double> next = scaled(residual);
    const double before = square;
    square = product(residual, next);
    for (size_t i = 0; i < x->size(); ++i) direction[i] = next[i] + square / before * direction[i];
  }
}

}  // namespace lte::bake
