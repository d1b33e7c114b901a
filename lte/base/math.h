// Small fixed vectors and the 3x4 affine transform that scenes are made of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace lte {

struct Vec2 {
  float x = 0, y = 0;
};

struct Vec3 {
  float x = 0, y = 0, z = 0;

  float& operator[](int axis) { return (&x)[axis]; }
  float operator[](int axis) const { return (&x)[axis]; }
  Vec3& operator+=(const Vec3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  Vec3& operator*=(float s) { return *this = {x * s, y * s, z * s}; }
  Vec3& operator*=(const Vec3& b) { return *this = {x * b.x, y * b.y, z * b.z}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// A linear Rec.709 triple. It is an alias, as the arithmetic is the same.
using Rgb = Vec3;

inline Vec3 operator+(Vec3 a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, Vec3 a) { return a * s; }
inline Vec3 operator/(Vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// The unit vector along `a`. The zero vector stays zero.
inline Vec3 normalize(const Vec3& a) {
  const float norm = length(a);
  return norm > 0 ? a / norm : a;
}
inline Vec3 min(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 max(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float max_component(const Vec3& a) { return std::max({a.x, a.y, a.z}); }
/// Rec.709 luminance.
inline float luminance(const Rgb& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Two unit vectors that complete the unit vector n to a right-handed frame (Duff et al. 2017).
inline void make_frame(const Vec3& n, Vec3* tangent, Vec3* bitangent) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  *tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *bitangent = {b, sign + n.y * n.y * a, -n.y};
}

/// An axis-aligned box, empty until a point extends it.
struct Bounds {
  Vec3 low{INFINITY, INFINITY, INFINITY};
  Vec3 high{-INFINITY, -INFINITY, -INFINITY};

  bool empty() const { return !(low.x <= high.x); }
  void extend(const Vec3& p) {
    low = min(low, p);
    high = max(high, p);
  }
  Vec3 extent() const { return empty() ? Vec3{} : high - low; }
  Vec3 center() const { return (low + high) * 0.5f; }
};

/// p -> M p + t; row-major, `m[row][3]` is the translation.
struct Affine {
  std::array<std::array<float, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3 point(const Vec3& p) const { return vector(p) + Vec3{m[0][3], m[1][3], m[2][3]}; }
  Vec3 vector(const Vec3& v) const {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  /// Negative for a mirroring transform, whose triangles must swap their winding.
  float determinant() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }
  /// `a * b` applies b first.
  friend Affine operator*(const Affine& a, const Affine& b) {
    Affine out;
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 4; ++col) {
        out.m[row][col] = col == 3 ? a.m[row][3] : 0.0f;
        for (int k = 0; k < 3; ++k) out.m[row][col] += a.m[row][k] * b.m[k][col];
      }
    }
    return out;
  }
};

inline constexpr float kPi = 3.14159265358979323846f;

}  // namespace lte
