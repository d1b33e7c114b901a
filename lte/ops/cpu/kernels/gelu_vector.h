// GELU and its slope on vectors, and loops over a row of them.
//
// Only kernel files include this.
#pragma once

#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {

/// From here on, either way, erf is ±1 but for 2e-8.
inline constexpr float kErfLimit = 4.0f;
/// erf(x / sqrt 2), by a ratio of polynomials to 2 units in the last place. `z` becomes x / sqrt 2,
/// clamped to ±kErfLimit.
static inline Float erf_of(const Float& x, Float& z) {
  const Float limit = splat(kErfLimit);
  z = x * splat(0.70710678118654752f);
  z = z < limit ? z : limit;
  z = z > -limit ? z : -limit;
  const Float s = z * z;
  Float p = s * splat(-2.72614225801306e-10f) + splat(2.77068142495902e-08f);
  p = p * s + splat(-2.10102402082508e-06f);
  p = p * s + splat(-5.69250639462346e-05f);
  p = p * s + splat(-7.34990630326855e-04f);
  p = p * s + splat(-2.95459980854025e-03f);
  p = p * s + splat(-1.60960333262415e-02f);
  Float q = s * splat(-1.45660718464996e-05f) + splat(-2.13374055278905e-04f);
  q = q * s + splat(-1.68282697438203e-03f);
  q = q * s + splat(-7.37332916720468e-03f);
  q = q * s + splat(-1.42647390514189e-02f);
  return z * p / q;
}

static inline Float gelu(const Float& x) {
  Float z;
  const Float erf = erf_of(x, z), half = x * splat(0.5f);
  const Float inside = half + half * erf;
  const Float upper = z < splat(kErfLimit) ? inside : x;
  return z > splat(-kErfLimit) ? upper : Float{};
}

/// Φ(x) + x φ(x), where Φ and φ are the normal distribution's.
static inline Float gelu_slope(const Float& x) {
  Float z;
  const Float erf = erf_of(x, z), half = splat(0.5f);
  const Float density = exponential(x * x * splat(-0.5f)) * splat(0.398942280401432678f);
  const Float inside = half + half * erf + x * density;
  const Float upper = z < splat(kErfLimit) ? inside : splat(1.0f) + x * density;
  return z > splat(-kErfLimit) ? upper : x * density;
}

/// GELU(x) and its slope from one erf, the same bits as gelu() and gelu_slope().
static inline Float gelu_with_slope(const Float& x, Float& slope) {
  Float z;
  const Float erf = erf_of(x, z), half = splat(0.5f), part = x * half;
  const Float density = exponential(x * x * splat(-0.5f)) * splat(0.398942280401432678f);
  const Float inside = half + half * erf + x * density;
  const Float upper = z < splat(kErfLimit) ? inside : splat(1.0f) + x * density;
  slope = z > splat(-kErfLimit) ? upper : x * density;
  const Float value = part + part * erf;
  const Float above = z < splat(kErfLimit) ? value : x;
  return z > splat(-kErfLimit) ? above : Float{};
}

/// Calls vectors(i) for whole vectors of `count` columns, then rest(i) for each of those left.
template <typename Vectors, typename Rest>
inline void over_row(int64_t count, const Vectors& vectors, const Rest& rest) {
  int64_t i = 0;
  for (; i + kLanes<float> <= count; i += kLanes<float>) vectors(i);
  for (; i < count; ++i) rest(i);
}

}  // namespace lte::ops::LTE_ISA
