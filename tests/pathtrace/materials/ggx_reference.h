// The GGX conductor as textbooks write it, in double and apart from the code under test: angles and
// Smith's Λ (Heitz 2014), and quadrature over the hemisphere.
#pragma once

#include <algorithm>
#include <cmath>

#include "lte/base/math.h"
#include "tests/support/closed_forms.h"

namespace lte::test {

/// A unit direction at polar angle theta and azimuth phi, radians.
inline Double3 direction_at(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

inline double smith_lambda(double cosine, double alpha) {
  const double tan2 = (1 - cosine * cosine) / (cosine * cosine);
  return (-1 + std::sqrt(1 + alpha * alpha * tan2)) / 2;
}

/// Walter et al. 2007, equation 33.
inline double ggx_d(double cosine, double alpha) {
  const double cos2 = cosine * cosine, tan2 = (1 - cos2) / cos2, a2 = alpha * alpha;
  return a2 / (M_PI * cos2 * cos2 * (a2 + tan2) * (a2 + tan2));
}

/// f cosθ_i with Schlick's Fresnel, of one channel; the normal is z.
inline double ggx_reflection(const Double3& out, const Double3& in, double alpha, double f0) {
  if (!(in[2] > 0 && out[2] > 0)) return 0;
  Double3 h{in[0] + out[0], in[1] + out[1], in[2] + out[2]};
  const double norm = std::sqrt(dot(h, h));
  for (double& c : h) c /= norm;
  const double masking = 1 / (1 + smith_lambda(in[2], alpha) + smith_lambda(out[2], alpha));
  const double fresnel = f0 + (1 - f0) * std::pow(1 - dot(h, in), 5);
  return fresnel * ggx_d(h[2], alpha) * masking / (4 * out[2]);
}

/// ∫ g dω over the upper hemisphere by midpoints. Steps shrink towards the angle `peak` (radians),
/// where g may be steep over `width`.
template <typename Function>
double integrate_hemisphere(const Function& g, double peak, double width, int steps = 1000) {
  // θ = peak + width sinh(s): uniform in s.
  const double low = std::asinh(-peak / width), high = std::asinh((M_PI / 2 - peak) / width);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double s = low + (high - low) * (i + 0.5) / steps, theta = peak + width * std::sinh(s);
    const double ring = std::sin(theta) * width * std::cosh(s) * (high - low) / steps;
    // The azimuth likewise around 0.
    const double across = width / std::max(std::sin(peak), width), end = std::asinh(M_PI / across);
    double around = 0;
    for (int j = 0; j < steps; ++j) {
      const double t = end * (2 * (j + 0.5) / steps - 1), phi = across * std::sinh(t);
      around += g(direction_at(theta, phi)) * across * std::cosh(t) * 2 * end / steps;
    }
    sum += around * ring;
  }
  return sum;
}

}  // namespace lte::test
