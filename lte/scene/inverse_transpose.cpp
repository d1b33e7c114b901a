#include "lte/scene/inverse_transpose.h"

#include <cmath>

namespace lte::scene {

std::optional<Matrix3> inverse_transpose(const Affine& transform) {
  const auto& m = transform.m;
  Matrix3 out;  // the cofactors first
  for (size_t i = 0; i < 3; ++i) {
    const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (size_t j = 0; j < 3; ++j) {
      const size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      out[i][j] = double{m[i1][j1]} * m[i2][j2] - double{m[i1][j2]} * m[i2][j1];
    }
  }
  const double determinant = m[0][0] * out[0][0] + m[0][1] * out[0][1] + m[0][2] * out[0][2];
  if (determinant == 0 || !std::isfinite(determinant)) return std::nullopt;
  for (auto& row : out) {
    for (double& value : row) value /= determinant;
  }
  return out;
}

}  // namespace lte::scene
