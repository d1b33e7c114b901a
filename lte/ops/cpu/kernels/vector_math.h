// Functions of vectors that several kernels need.
//
// Only kernel files include this.
#pragma once

#include <cstdint>

#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {

static inline float horizontal_sum(const Vector<float>& v) {
  float sum = 0;
  for (int lane = 0; lane < kLanes<float>; ++lane) sum += v[lane];
  return sum;
}

/// 2^n times a polynomial of the rest, to 2 units in the last place; for x <= 0, and 0 below -87.
static inline Vector<float> exponential(const Vector<float>& x) {
  const Vector<float> magic = splat(12582912.0f);  // 1.5 * 2^23: adding it rounds to a whole number
  const Vector<float> whole = x * splat(1.44269504f) + magic, n = whole - magic;
  Vector<float> r = x - n * splat(0.693359375f);
  r = r + n * splat(2.12194440e-4f);
  Vector<float> p = r * splat(1.9875691500e-4f) + splat(1.3981999507e-3f);
  p = p * r + splat(8.3334519073e-3f);
  p = p * r + splat(4.1665795894e-2f);
  p = p * r + splat(1.6666665459e-1f);
  p = p * r + splat(5.0000001201e-1f);
  p = p * r * r + r + splat(1.0f);
  Vector<uint32_t> bits, shift;  // unsigned: what overflows below -87 is thrown away
  __builtin_memcpy(&bits, &p, sizeof bits);
  __builtin_memcpy(&shift, &whole, sizeof shift);
  bits += shift << 23;
  __builtin_memcpy(&p, &bits, sizeof p);
  return x > splat(-87.0f) ? p : Vector<float>{};
}

}  // namespace lte::ops::LTE_ISA
