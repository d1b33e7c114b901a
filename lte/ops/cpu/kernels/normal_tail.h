// The upper tail of the normal distribution on vectors, which GELU is made of.
//
// A polynomial of few terms holds on a short interval alone, so there is one for each of as many
// intervals as a register has lanes. The coefficients of an order lie in one register, and one
// instruction hands every lane that of its own interval. Without such an instruction erf() is a
// ratio of polynomials, whose division takes as long as everything else.
//
// Only kernel files include this.
#pragma once

#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lte::ops::LTE_ISA {

#if defined(__AVX2__)
#if defined(__AVX512F__)
inline constexpr int kTailOrder = 5;
inline constexpr float kTailStep = 0.375f;
#else
inline constexpr int kTailOrder = 6;
inline constexpr float kTailStep = 0.8125f;
#endif
/// From here on the tail, below 10^-8, is 0.
inline constexpr float kTailEnd = kTailStep * (kLanes<float> - 1);

/// Column i: the coefficients, lowest first, of Φ(−(i kTailStep + t)), |t| <= kTailStep / 2,
/// interpolated in Chebyshev's points. The last one's is 0 at t = 0, where it ends.
/// |x| times the error is below 6 · 10^-8, rounding included.
alignas(kVectorBytes) inline constexpr float kTail[kTailOrder + 1][kLanes<float>] = {
#if defined(__AVX512F__)
    {0.5f, 0.353830248f, 0.22662735f, 0.130294517f, 0.066807203f, 0.030396359f, 0.0122244712f,
     0.00433244789f, 0.00134989817f, 0.000369078713f, 8.8417466e-05f, 1.85368226e-05f,
     3.39770349e-06f, 5.44051034e-07f, 7.6051677e-08f, 0},
    {-0.398942262f, -0.37185508f, -0.301137447f, -0.211876646f, -0.1295176f, -0.0687862784f,
     -0.0317396522f, -0.0127241816f, -0.00443184841f, -0.00134111883f, -0.000352595729f,
     -8.05404779e-05f, -1.59837546e-05f, -2.75594698e-06f, -4.12848294e-07f, -1.04311073e-06f},
    {-3.25816472e-07f, 0.0697210059f, 0.112924434f, 0.119179703f, 0.0971386507f, 0.064488098f,
     0.0357077979f, 0.0167006962f, 0.00664769718f, 0.00226300396f, 0.000661024824f, 0.000166071419f,
     3.59478508e-05f, 6.713125e-06f, 1.08266431e-06f, -2.93984249e-05f},
    {0.0664974228f, 0.0532600358f, 0.0219581742f, -0.00937937573f, -0.0269824453f, -0.0288400669f,
     -0.021490572f, -0.0124923876f, -0.00590919005f, -0.00232250546f, -0.000767609279f,
     -0.000214969448f, -5.12744264e-05f, -1.04544961e-05f, -1.82708959e-06f, -0.000360499631f},
    {-6.50142974e-05f, -0.0164752565f, -0.022778498f, -0.0171564873f, -0.00610545743f,
     0.00269760168f, 0.00608494179f, 0.00539880386f, 0.00332963839f, 0.00159261597f,
     0.000616452249f, 0.00019729558f, 5.28762648e-05f, 1.19640499e-05f, 2.29834791e-06f,
     -0.00192086259f},
    {-0.00974037126f, -0.00670827413f, 0.000129060209f, 0.00523863174f, 0.00583940698f,
     0.00328594237f, 0.00047567318f, -0.000956879696f, -0.00110349746f, -0.000720158278f,
     -0.000343544991f, -0.000128940417f, -3.93466507e-05f, -9.93947106e-06f, -2.10185158e-06f,
     -0.00372649124f},
#else
    {0.5f, 0.2082524f, 0.0520812795f, 0.00739460718f, 0.000577025057f, 2.42749738e-05f,
     5.4404228e-07f, 0},
    {-0.398942351f, -0.286786884f, -0.106538452f, -0.0204525422f, -0.00202904013f, -0.0001040352f,
     -2.75761317e-06f, -4.81971597e-07f},
    {2.2327456e-06f, 0.116506957f, 0.0865624323f, 0.0249266885f, 0.00329719018f, 0.000211300168f,
     6.7182682e-06f, -8.64047252e-06f},
    {0.0664572045f, 0.0162548069f, -0.0291226823f, -0.0168505386f, -0.00323417992f, -0.0002682388f,
     -1.03760094e-05f, -7.40203977e-05f},
    {0.000235718835f, -0.0227113366f, -0.00259678112f, 0.00611029379f, 0.0020785518f,
     0.000237681888f, 1.15927533e-05f, -0.000302576111f},
    {-0.0108388225f, 0.00112010725f, 0.00510465261f, -0.00037430416f, -0.000861062552f,
     -0.000159631818f, -1.07373899e-05f, -0.000596534694f},
    {0.00159421668f, 0.00278569339f, -0.00101214566f, -0.000635186734f, 0.000184206612f,
     7.29952153e-05f, 6.76929494e-06f, -0.000451211614f},
#endif
};

/// Φ(−a) for 0 <= a <= kTailEnd.
static inline Float normal_tail(const Float& a) {
  // Adding 1.5 · 2^23 rounds to a whole number, which the last bits then are.
  const Float magic = splat(12582912.0f), interval = a * splat(1 / kTailStep) + magic;
  const Float t = a - (interval - magic) * splat(kTailStep);
  const auto coefficient = [&](int order) {
    const Float row = load(kTail[order]);
#if defined(__AVX512F__)
    return (Float)_mm512_maskz_permutexvar_ps(0xffff, (__m512i)interval, (__m512)row);
#else
    return (Float)_mm256_permutevar8x32_ps((__m256)row, (__m256i)interval);
#endif
  };
  Float tail = coefficient(kTailOrder);
#pragma GCC unroll 8
  for (int order = kTailOrder - 1; order >= 0; --order) tail = tail * t + coefficient(order);
  return tail;
}

/// max(x, 0); what is not a number stays that.
static inline Float positive_part(const Float& x) {
#if defined(__AVX512F__)
  return (Float)_mm512_maskz_max_ps(0xffff, __m512{}, (__m512)x);
#else
  return (Float)_mm256_max_ps(__m256{}, (__m256)x);
#endif
}

/// min(|x|, kTailEnd).
static inline Float tail_argument(const Float& x) {
  // The forms with a mask of all lanes: GCC 12 warns of the others, that they read what is not set.
#if defined(__AVX512F__)
  const __m512 magnitude = _mm512_abs_ps((__m512)x);
  return (Float)_mm512_maskz_min_ps(0xffff, magnitude, (__m512)splat(kTailEnd));
#else
  const __m256 magnitude = _mm256_and_ps((__m256)x, (__m256)splat(0x7fffffff));
  return (Float)_mm256_min_ps(magnitude, (__m256)splat(kTailEnd));
#endif
}
#else
inline constexpr float kTailEnd = 5.65685425f;

/// Φ(−a) for 0 <= a <= kTailEnd; 0 at its end.
static inline Float normal_tail(const Float& a) {
  const Float z = a * splat(0.70710678118654752f), s = z * z;
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
  const Float half = splat(0.5f);
  return a < splat(kTailEnd) ? half - half * (z * p / q) : Float{};
}

static inline Float positive_part(const Float& x) { return x < Float{} ? Float{} : x; }

static inline Float tail_argument(const Float& x) {
  const Float magnitude = x < Float{} ? -x : x, end = splat(kTailEnd);
  return magnitude < end ? magnitude : end;
}
#endif

}  // namespace lte::ops::LTE_ISA
