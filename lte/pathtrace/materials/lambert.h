// Internal: ideal diffuse reflection, f = albedo / π.
//
// Directions are drawn with a density in proportion to the cosine, so that f cosθ / pdf is the
// albedo whatever the direction: paths multiply their throughput by it, and blocks of them use
// these functions lane by lane (transport/path_kernels.cpp).
#pragma once

#include "lte/base/math.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/materials/bsdf.h"

namespace lte::pathtrace {

/// Solid-angle density of a direction that is drawn. @param cosine  to the normal, not negative
inline float lambert_pdf(float cosine) { return cosine_pdf(cosine); }

/// f cosθ, 1/sr. @param cosine  of the incident direction, not negative
inline Rgb lambert_value(const Rgb& albedo, float cosine) { return albedo * lambert_pdf(cosine); }

/// f cosθ / pdf of every direction that is drawn.
inline const Rgb& lambert_weight(const Rgb& albedo) { return albedo; }

/// A direction for `u` in [0, 1)². @param normal  unit @param pdf  takes lambert_pdf() of it
inline Vec3 sample_lambert(const Vec3& normal, const Vec2& u, float* pdf) {
  return cosine_direction(normal, u, pdf);
}

}  // namespace lte::pathtrace
