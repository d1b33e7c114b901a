// Real spherical harmonics, and how well they hold a map of radiance by direction: what the paper
// compares its radiance decoder with (supplement, section 4).
#pragma once

#include <span>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/base/enum_names.h"
#include "lte/base/math.h"

namespace lte::experiments {

/// Y_lm of one direction for all l up to `degree`: (degree + 1)² values, at l (l + 1) + m.
/// Orthonormal over the sphere.
/// @param direction  unit
std::vector<double> spherical_harmonics(int degree, const Vec3& direction);

/// How the coefficients of a map come about.
enum class HarmonicFit {
  Projected,     ///< by integrals over the sphere, with nothing below the horizon
  Windowed,      ///< these times sinc(l / (degree + 1)), which damps ringing (Lanczos)
  LeastSquares,  ///< those with the least squared error over the hemisphere, under the cosine
};
constexpr EnumNames<HarmonicFit, 3> enum_names(HarmonicFit) {
  return {{{HarmonicFit::Projected, "projected"},
           {HarmonicFit::Windowed, "windowed"},
           {HarmonicFit::LeastSquares, "least_squares"}}};
}

/// What the harmonics of a degree make of tables of cells.
class HarmonicFitter {
 public:
  /// @param directions   [cells] in the frame of the tables: cells of equal projected solid angle
  /// @param solid_angle  [cells] sr
  HarmonicFitter(int degree, HarmonicFit fit, std::span<const Vec3> directions,
                 std::span<const double> solid_angle);

  /// @param cells  [cells, tables] float64
  /// @return  the same shape; values may be negative
  at::Tensor reconstruct(const at::Tensor& cells) const {
    return basis_.matmul(analysis_.matmul(cells));
  }

 private:
  at::Tensor basis_;     ///< [cells, coefficients] float64
  at::Tensor analysis_;  ///< [coefficients, cells]: a table's coefficients
};

}  // namespace lte::experiments
