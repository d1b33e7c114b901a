// Functions of vectors that several kernels need.
//
// Only kernel files include this.
#pragma once

#include <cstdint>

#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {

/// By halves: lane by lane each addition would wait for the one before.
static inline float horizontal_sum(const Vector<float>& v) {
  typedef float Quarter __attribute__((vector_size(16)));
  Quarter part[kVectorBytes / 16];
  __builtin_memcpy(part, &v, sizeof part);
#if defined(__AVX512F__)
  part[0] += part[2];
  part[1] += part[3];
#endif
#if defined(__AVX2__)
  part[0] += part[1];
#endif
  return (part[0][0] + part[0][2]) + (part[0][1] + part[0][3]);
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

/// 2^x to 3 · 10^-7 of it; |x| <= 120.
static inline Vector<float> power_of_two(const Vector<float>& x) {
  const Vector<float> magic = splat(12582912.0f);  // as above
  const Vector<float> whole = x + magic, f = x - (whole - magic);
  Vector<float> p = f * splat(1.33908634e-3f) + splat(9.67603192e-3f);
  p = p * f + splat(5.55035711e-2f);
  p = p * f + splat(2.40221075e-1f);
  p = p * f + splat(6.93147188e-1f);
  p = p * f + splat(1.0f);
  Vector<uint32_t> bits, shift;
  __builtin_memcpy(&bits, &p, sizeof bits);
  __builtin_memcpy(&shift, &whole, sizeof shift);
  bits += shift << 23;
  __builtin_memcpy(&p, &bits, sizeof p);
  return p;
}

/// 2^x of a score less the logarithm of its query's sum; 0 below 2^-120.
static inline Vector<float> attention_weight(const Vector<float>& x) {
  const Vector<float> power = power_of_two(x);
  return x > splat(-120.0f) ? power : Vector<float>{};
}

/// log(1 + exp(x)) to 10^-6 of the result, where that is at least 10^-30; what is not a number
/// stays visible.
static inline Vector<float> softplus(const Vector<float>& x) {
  const Vector<float> zero{};
  const Vector<float> t = exponential(x > zero ? -x : x);  // in [0, 1]
  // log(1 + t) = 2 artanh(s), s <= 1/3: the next term is below 2e-8 of the sum.
  const Vector<float> s = t / (t + splat(2.0f)), q = s * s;
  Vector<float> p = q * splat(1.0f / 13) + splat(1.0f / 11);
  p = p * q + splat(1.0f / 9);
  p = p * q + splat(1.0f / 7);
  p = p * q + splat(1.0f / 5);
  p = p * q + splat(1.0f / 3);
  p = p * q + splat(1.0f);
  return (x < zero ? zero : x) + s * splat(2.0f) * p;
}

/// log(x) to 2 units in the last place, for x > 0 that is not subnormal; what is no number stays.
static inline Vector<float> logarithm(const Vector<float>& x) {
  Vector<uint32_t> bits;
  __builtin_memcpy(&bits, &x, sizeof bits);
  // x = m 2^e with m in [√½, √2).
  const Vector<uint32_t> shifted = bits - 0x3f3504f3U;
  const Vector<int32_t> exponent = (Vector<int32_t>)shifted >> 23;
  bits -= (Vector<uint32_t>)exponent << 23;
  Vector<float> m;
  __builtin_memcpy(&m, &bits, sizeof m);
  const Vector<float> e = __builtin_convertvector(exponent, Vector<float>);
  const Vector<float> r = m - splat(1.0f), square = r * r;
  Vector<float> p = r * splat(7.0376836292e-2f) - splat(1.1514610310e-1f);
  p = p * r + splat(1.1676998740e-1f);
  p = p * r - splat(1.2420140846e-1f);
  p = p * r + splat(1.4249322787e-1f);
  p = p * r - splat(1.6668057665e-1f);
  p = p * r + splat(2.0000714765e-1f);
  p = p * r - splat(2.4999993993e-1f);
  p = p * r + splat(3.3333331174e-1f);
  p = p * r * square - e * splat(2.12194440e-4f) - square * splat(0.5f);
  const Vector<float> log = r + p + e * splat(0.693359375f);
  return x < splat(__builtin_inff()) ? log : x;
}

/// log(1 + x) as closely, for x >= 0.
static inline Vector<float> logarithm_of_one_more(const Vector<float>& x) {
  const Vector<float> sum = x + splat(1.0f);
  // What the sum has rounded away, by the slope of the logarithm.
  const Vector<float> lost = (x - (sum - splat(1.0f))) / sum;
  return x < splat(__builtin_inff()) ? logarithm(sum) + lost : x;
}

}  // namespace lte::ops::LTE_ISA
