#include "lte/scene/pbrt/transform.h"

#include <cmath>
#include <utility>

namespace lte::scene::pbrt {
namespace {

using Vector = std::array<double, 3>;

Vector cross3(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double norm(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

/// False for a vector that has no direction.
bool make_unit(Vector* a) {
  const double length = norm(*a);
  if (!(length > 0) || !std::isfinite(length)) return false;
  for (double& value : *a) value /= length;
  return true;
}

/// The determinant of the upper left 3x3 over the product of its columns' lengths: 0 where the
/// transform flattens space, whatever its scale.
double relative_determinant(const Transform& t) {
  std::array<Vector, 3> columns{};
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 3; ++col) columns[col][row] = t.m[row][col];
  }
  for (Vector& column : columns) {
    if (!make_unit(&column)) return 0;
  }
  const Vector normal = cross3(columns[0], columns[1]);
  return normal[0] * columns[2][0] + normal[1] * columns[2][1] + normal[2] * columns[2][2];
}

void check_regular(const Transform& t, const Location& at) {
  for (const auto& row : t.m) {
    for (const double value : row) {
      if (!std::isfinite(value)) fail(at, "the transform here is beyond the range of numbers");
    }
  }
  if (t.m[3] != std::array<double, 4>{0, 0, 0, 1})
    fail(at, "the transform here is not affine: its last row is not 0 0 0 1");
  if (!(std::abs(relative_determinant(t)) > 1e-12))
    fail(at, "the transform here is singular: it flattens space");
}

}  // namespace

Transform operator*(const Transform& a, const Transform& b) {
  Transform out;
  for (size_t row = 0; row < 4; ++row) {
    for (size_t col = 0; col < 4; ++col) {
      out.m[row][col] = 0;
      for (size_t k = 0; k < 4; ++k) out.m[row][col] += a.m[row][k] * b.m[k][col];
    }
  }
  return out;
}

Transform translate(double x, double y, double z) {
  Transform out;
  out.m[0][3] = x;
  out.m[1][3] = y;
  out.m[2][3] = z;
  return out;
}

Transform scale(double x, double y, double z) {
  Transform out;
  out.m[0][0] = x;
  out.m[1][1] = y;
  out.m[2][2] = z;
  return out;
}

Transform rotate(double degrees, double x, double y, double z) {
  Vector axis{x, y, z};
  if (!make_unit(&axis)) return {};
  const double angle = degrees * (M_PI / 180), c = std::cos(angle), s = std::sin(angle);
  Transform out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 3; ++col)
      out.m[row][col] = axis[row] * axis[col] * (1 - c) + (row == col ? c : 0);
    // + s * [axis]x, whose rows are 0 -z y, z 0 -x, -y x 0
    out.m[row][(row + 2) % 3] += s * axis[(row + 1) % 3];
    out.m[row][(row + 1) % 3] -= s * axis[(row + 2) % 3];
  }
  return out;
}

Transform look_at(const std::array<double, 16>& n, const Location& at) {
  const Vector eye{n[0], n[1], n[2]};
  Vector ahead{n[3] - n[0], n[4] - n[1], n[5] - n[2]}, up{n[6], n[7], n[8]};
  if (!make_unit(&ahead)) fail(at, "LookAt: the eye and the target coincide");
  if (!make_unit(&up)) fail(at, "LookAt: the up vector has no direction");
  Vector right = cross3(up, ahead);
  if (!(norm(right) > 1e-9) || !make_unit(&right))
    fail(at, "LookAt: the up vector lies along the view");
  const Vector above = cross3(ahead, right);
  Transform out;
  for (size_t row = 0; row < 3; ++row) {
    const Vector& axis = row == 0 ? right : row == 1 ? above : ahead;
    for (size_t col = 0; col < 3; ++col) out.m[row][col] = axis[col];
    out.m[row][3] = -(axis[0] * eye[0] + axis[1] * eye[1] + axis[2] * eye[2]);
  }
  return out;
}

Transform from_columns(const std::array<double, 16>& columns) {
  Transform out;
  for (size_t i = 0; i < 16; ++i) out.m[i % 4][i / 4] = columns[i];
  return out;
}

Transform inverse(const Transform& t, const Location& at) {
  check_regular(t, at);
  // Cofactors of the 3x3, then the translation.
  Transform out;
  const auto& m = t.m;
  std::array<Vector, 3> rows{
      {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}}};
  const std::array<Vector, 3> columns{
      {cross3(rows[1], rows[2]), cross3(rows[2], rows[0]), cross3(rows[0], rows[1])}};
  const double determinant =
      rows[0][0] * columns[0][0] + rows[0][1] * columns[0][1] + rows[0][2] * columns[0][2];
  for (size_t row = 0; row < 3; ++row) {
    out.m[row][3] = 0;
    for (size_t col = 0; col < 3; ++col) {
      out.m[row][col] = columns[col][row] / determinant;
      out.m[row][3] -= out.m[row][col] * m[col][3];
    }
  }
  for (const auto& row : out.m) {
    for (const double value : row) {
      if (!std::isfinite(value)) fail(at, "the transform here has no finite inverse");
    }
  }
  return out;
}

Affine to_affine(const Transform& t, const Location& at) {
  check_regular(t, at);
  Affine out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 4; ++col) {
      out.m[row][col] = static_cast<float>(t.m[row][col]);
      if (!std::isfinite(out.m[row][col]))
        fail(at, "the transform here is beyond the range of float");
    }
  }
  return out;
}

}  // namespace lte::scene::pbrt
