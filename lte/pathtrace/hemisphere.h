// Internal: directions over a hemisphere from points of the unit square.
#pragma once

#include <cmath>

#include "lte/base/math.h"

namespace lte::pathtrace {

/// cos(2πu) and sin(2πu) up to the sign of both, for u in [0, 1): Taylor polynomials of the half
/// angle (error 6e-8) and its doubling. No branch and no range reduction, which cost as much as a
/// short ray.
inline Vec2 unit_circle(float u) {
  const float a = kPi * (u - 0.5f), x = a * a;
  const float s =
      a *
      (1 + x * (-1.0f / 6 + x * (1.0f / 120 + x * (-1.0f / 5040 +
                                                   x * (1.0f / 362880 + x * (-1.0f / 39916800))))));
  const float c =
      1 +
      x * (-1.0f / 2 +
           x * (1.0f / 24 + x * (-1.0f / 720 + x * (1.0f / 40320 + x * (-1.0f / 3628800 +
                                                                        x * (1.0f / 479001600))))));
  return {1 - 2 * s * s, 2 * s * c};
}

/// Solid-angle density of cosine-distributed directions.
inline float cosine_pdf(float cosine) { return cosine * (1 / kPi); }

/// A cosine-distributed unit direction around `normal`; `pdf` takes its solid-angle density.
inline Vec3 cosine_direction(const Vec3& normal, const Vec2& u, float* pdf) {
  const float radius = std::sqrt(u.x);
  const Vec2 around = unit_circle(u.y);
  const float cosine = std::sqrt(1 - u.x);  // positive: u.x < 1
  Vec3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  *pdf = cosine_pdf(cosine);
  return tangent * (radius * around.x) + bitangent * (radius * around.y) + normal * cosine;
}

}  // namespace lte::pathtrace
