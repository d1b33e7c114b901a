// Closed forms of radiometry, in double and apart from the code under test.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "lte/base/math.h"

namespace lte::test {

using Double3 = std::array<double, 3>;

inline Double3 to_double(const Vec3& v) { return {v.x, v.y, v.z}; }
inline double dot(const Double3& a, const Double3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Double3 cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Irradiance per unit radiance of a polygon seen from `position` with unit normal `n`: Lambert's
/// sum over edges, of the part above the horizon. The sign of the polygon's winding does not
/// matter.
inline double polygon_irradiance(const std::vector<Vec3>& polygon, const Vec3& position,
                                 const Vec3& normal) {
  const Double3 n = to_double(normal);
  std::vector<Double3> relative, clipped;
  for (const Vec3& p : polygon) {
    const Double3 a = to_double(p), o = to_double(position);
    relative.push_back({a[0] - o[0], a[1] - o[1], a[2] - o[2]});
  }
  for (size_t i = 0; i < relative.size(); ++i) {
    const Double3 &a = relative[i], &b = relative[(i + 1) % relative.size()];
    const double ha = dot(a, n), hb = dot(b, n);
    if (ha > 0) clipped.push_back(a);
    if (ha * hb < 0) {
      const double t = ha / (ha - hb);
      clipped.push_back(
          {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
    }
  }
  double sum = 0;
  for (size_t i = 0; i < clipped.size(); ++i) {
    const Double3 &a = clipped[i], &b = clipped[(i + 1) % clipped.size()];
    const Double3 axis = cross(a, b);
    const double sine = std::sqrt(dot(axis, axis));
    if (sine > 0) sum += std::atan2(sine, dot(a, b)) * dot(axis, n) / sine;
  }
  return std::fabs(sum) / 2;
}

/// 1 + x + ... + x^(terms − 1).
inline double geometric_sum(double x, int terms) {
  double sum = 0, power = 1;
  for (int i = 0; i < terms; ++i) {
    sum += power;
    power *= x;
  }
  return sum;
}

}  // namespace lte::test
