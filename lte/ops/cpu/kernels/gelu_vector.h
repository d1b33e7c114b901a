// GELU and its slope on vectors, and loops over a row of them.
//
// Only kernel files include this.
#pragma once

#include "lte/ops/cpu/kernels/normal_tail.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {

/// max(x, 0) − |x| Φ(−|x|), where Φ is the normal distribution's: no rounding of 1 + erf() comes
/// between a large x and its answer.
static inline Float gelu(const Float& x) {
  const Float a = tail_argument(x);
  return positive_part(x) - a * normal_tail(a);
}

/// Φ(x) + x φ(x) with φ the density, from Φ(−|x|).
static inline Float slope_from(const Float& x, const Float& tail) {
  const Float density = exponential(x * x * splat(-0.5f)) * splat(0.398942280401432678f);
  const Float below = x < Float{} ? tail : splat(1.0f) - tail;
  return below + x * density;
}

static inline Float gelu_slope(const Float& x) {
  return slope_from(x, normal_tail(tail_argument(x)));
}

/// GELU(x) and its slope from one tail, the same bits as gelu() and gelu_slope().
static inline Float gelu_with_slope(const Float& x, Float& slope) {
  const Float a = tail_argument(x), tail = normal_tail(a);
  slope = slope_from(x, tail);
  return positive_part(x) - a * tail;
}

/// Calls vectors(i) for whole vectors of `count` columns, then rest(i) for each of those left.
template <typename Vectors, typename Rest>
inline void over_row(int64_t count, const Vectors& vectors, const Rest& rest) {
  int64_t i = 0;
  for (; i + kLanes<float> <= count; i += kLanes<float>) vectors(i);
  for (; i < count; ++i) rest(i);
}

}  // namespace lte::ops::LTE_ISA
