// Products of bfloat16 operands with sums in float32. Activations come in float32 and are rounded
// to the nearest even bfloat16 as a product reads them.
//
// This file is compiled twice for AVX-512. With AVX512-BF16 one instruction multiplies 16 pairs and
// adds them to 16 sums, which is why everything here comes in pairs of inputs. Without it a
// bfloat16 is the upper half of a float32, so a pair is taken apart by a shift and a mask, and two
// float32 instructions in the order of the one give the same sums. Rounding by hand adds half of
// the last place kept, less one where that place is even, and lets the carry run.
//
// With AMX it is compiled once more: on an Emerald Rapids Xeon matrix registers multiply 26 times
// as fast as that instruction. Even and odd inputs are summed by themselves there, so that the last
// bits differ.
#include <algorithm>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/sum_query.h"
#include "lte/ops/cpu/kernels/transpose.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"
#if defined(__AMX_BF16__)
#include "lte/ops/cpu/kernels/amx_product.h"
#endif

namespace lte::ops::LTE_ISA {
namespace {

typedef uint16_t Halves __attribute__((vector_size(kVectorBytes / 2)));
/// Rows whose rounded inputs, 24 KiB, stay in the first-level cache.
constexpr int64_t kRowsAtOnce = 96;
#if defined(__AMX_BF16__)
constexpr int64_t kPairsAtOnce = 64;  ///< of a transposed factor
#endif

#if !defined(__AVX512BF16__)
/// The bfloat16 in the upper half of each lane; the lower half is what was rounded away.
Bits rounded(const Float& value) {
  Bits bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  return bits + splat(uint32_t{0x7fff}) + (bits >> 16 & splat(uint32_t{1}));
}
#endif

Halves narrow(const Float& value) {
#if defined(__AVX512BF16__)
  return (Halves)_mm512_cvtneps_pbh((__m512)value);
#else
  return __builtin_convertvector(rounded(value) >> 16, Halves);
#endif
}

/// `K` values, and what is past them to two whole vectors, as pairs; the last one's partner is
/// zero.
void narrow_row(const float* x, int64_t K, uint32_t* out) {
#if defined(__AVX512BF16__)
  for (int64_t i = 0; i < K; i += 2 * kLanes<float>) {
    const auto values =
        (Bits)_mm512_cvtne2ps_pbh((__m512)load(x + i + kLanes<float>), (__m512)load(x + i));
    store(out + i / 2, values);
  }
#else
  for (int64_t i = 0; i < K; i += kLanes<float>) {
    const Halves values = narrow(load(x + i));
    __builtin_memcpy(out + i / 2, &values, sizeof values);
  }
#endif
  if (K % 2 != 0) out[K / 2] &= 0xffff;
}

#if defined(__AMX_BF16__)
void add_bias(const MatrixProduct<float, uint32_t>& p) {
  for (int64_t r = 0; r < p.rows; ++r) {
    for (int64_t c = 0; c < p.blocks * kBlock; c += kLanes<float>) {
      float* to = p.out + r * kPanel + c;
      store(to, load(to) + load(p.bias + c));
    }
  }
}

/// A product whose left factor has been made pairs.
void multiply_pairs(MatrixProduct<uint32_t, uint32_t> p) {
  amx_multiply({p.x, PairProduct::kRowStride, kPanel, p});
}

void multiply_transposed(const uint32_t* left, int64_t rows, int64_t pairs, const uint32_t* right,
                         int64_t blocks, bool add, float* out) {
  alignas(kAmxRowBytes) uint32_t turned[kPanel * kPairsAtOnce];
  for (int64_t k = 0; k < pairs; k += kPairsAtOnce) {
    const int64_t count = pairs - k < kPairsAtOnce ? pairs - k : kPairsAtOnce;
    for (int64_t i = 0; i < count; i += kAmxRows) {
      for (int64_t r = 0; r < rows; r += kAmxRows) {
        transpose_block(left + (k + i) * kPanel + r, kPanel,
                        count - i < kAmxRows ? count - i : kAmxRows, turned + r * kPairsAtOnce + i,
                        kPairsAtOnce, [](const Bits& block) { return block; });
      }
    }
    amx_multiply({turned,
                  kPairsAtOnce,
                  kPanel,
                  {nullptr, rows, count, right + k * kPanel, kPanel, kBlock, nullptr, blocks,
                   add || k > 0, out}});
  }
}
#else
void multiply_pairs(MatrixProduct<uint32_t, uint32_t> p) { multiply_blocks<PairProduct>(p); }

void multiply_transposed(const uint32_t* left, int64_t rows, int64_t pairs, const uint32_t* right,
                         int64_t blocks, bool add, float* out) {
  multiply_blocks<TransposedPairProduct>(
      {left, rows, pairs, right, kPanel, kBlock, nullptr, blocks, add, out});
}
#endif

void multiply(MatrixProduct<float, uint32_t> p) {
#if defined(__AMX_BF16__)
  if (p.add && p.bias != nullptr) {  // a sum begins with one of them
    add_bias(p);
    p.bias = nullptr;
  }
#endif
  alignas(kVectorBytes) uint32_t pairs[kRowsAtOnce * PairProduct::kRowStride];
  for (int64_t r = 0; r < p.rows; r += kRowsAtOnce) {
    const int64_t count = p.rows - r < kRowsAtOnce ? p.rows - r : kRowsAtOnce;
    for (int64_t i = 0; i < count; ++i) {
      narrow_row(p.x + (r + i) * kPanel, p.K, pairs + i * PairProduct::kRowStride);
    }
    multiply_pairs({pairs, count, (p.K + 1) / 2, p.weight, p.row_stride, p.block_stride, p.bias,
                    p.blocks, p.add, p.out + r * kPanel});
  }
}

Bits pair(const Float& low, const Float& high) {
#if defined(__AVX512BF16__)
  typedef uint16_t WholeHalves __attribute__((vector_size(kVectorBytes)));
  const auto halves = (WholeHalves)_mm512_cvtne2ps_pbh((__m512)high, (__m512)low);
  return (Bits)__builtin_shufflevector(halves, halves, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6,
                                       22, 7, 23, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14,
                                       30, 15, 31);
#else
  return rounded(low) >> 16 | (rounded(high) & splat(uint32_t{0xffff0000}));
#endif
}

void pair_rows(const float* even, const float* odd, int64_t count, uint32_t* out) {
  int64_t i = 0;
  for (; i + kLanes<float> <= count; i += kLanes<float>) {
    store(out + i, pair(load(even + i), odd != nullptr ? load(odd + i) : Float{}));
  }
  for (; i < count; ++i) {
    out[i] = pair(splat(even[i]), odd != nullptr ? splat(odd[i]) : Float{})[0];
  }
}

void transpose(TransposedRows<uint32_t> rows) {
  transpose_rows(rows, [](const Bits& block) { return block; });
}

/// A vector of float32 as bfloat16, one after the other.
void store_narrow(const Float& value, uint32_t* out) {
  const Halves halves = narrow(value);
  __builtin_memcpy(out, &halves, sizeof halves);
}

void attention_gradient(AttentionGradient a, AttentionPairs to) {
  for (int64_t r = 0; r < a.rows; r += 2) {
    const bool two = r + 1 < a.rows;
    const int64_t odd = two ? kPanel : 0;  // else the same row again, which counts for nothing
    const float *scores = a.scores + r * kPanel, *grad = a.grad + r * kPanel;
    const Float log_sum = splat(a.log_sum[r]), mean = splat(a.mean[r]);
    const Float next_log_sum = splat(a.log_sum[r + two]), next_mean = splat(a.mean[r + two]);
    const Float present = splat(two ? 1.0f : 0.0f);
    uint32_t *weights = to.weights + r / 2 * kPanel, *by_scores = to.by_scores + r / 2 * kPanel,
             *by_key = to.by_key + r * (kPanel / 2);
#pragma GCC unroll 2
    for (int64_t i = 0; i < a.blocks * kBlock; i += kLanes<float>) {
      const Float first = attention_weight(load(scores + i) - log_sum),
                  second = attention_weight(load(scores + odd + i) - next_log_sum) * present;
      const Float by_first = first * (load(grad + i) - mean),
                  by_second = second * (load(grad + odd + i) - next_mean);
      store(weights + i, pair(first, second));
      store(by_scores + i, pair(by_first, by_second));
      store_narrow(by_first, by_key + i / 2);
      if (two) store_narrow(by_second, by_key + kPanel / 2 + i / 2);
    }
    if (to.keys % 2 != 0) {
      by_key[to.keys / 2] &= 0xffff;
      if (two) by_key[kPanel / 2 + to.keys / 2] &= 0xffff;
    }
  }
}

/// x within ±4, where the polynomials below end.
Float limited(const Float& x) {
  const Float limit = splat(4.0f), z = x < limit ? x : limit;
  return z > -limit ? z : -limit;
}

/// x/2 (1 + erf(x/√2)) with a polynomial of z = limited(x) that is 1 where it ends. It has no
/// division, as the float32 form has, since the rounding that follows hides the difference.
Float gelu(const Float& x, const Float& z) {
  const Float s = z * z;
  Float p = s * splat(4.517630855e-08f) + splat(-3.177648331e-06f);
  p = p * s + splat(9.552764627e-05f);
  p = p * s + splat(-1.624373612e-03f);
  p = p * s + splat(1.752737492e-02f);
  p = p * s + splat(-1.291088073e-01f);
  p = p * s + splat(7.957405188e-01f);
  const Float half = x * splat(0.5f);
  return half + half * (z * p);
}
Float gelu(const Float& x) { return gelu(x, limited(x)); }

/// The slope of GELU, Φ(x) + x φ(x), to 3 · 10^-4, of z = limited(x).
Float gelu_slope(const Float& z) {
  const Float s = z * z;
  Float p = s * splat(-1.641892621e-08f) + splat(1.213758871e-06f);
  p = p * s + splat(-3.845854054e-05f);
  p = p * s + splat(6.876341068e-04f);
  p = p * s + splat(-7.687375773e-03f);
  p = p * s + splat(5.591463171e-02f);
  p = p * s + splat(-2.620295969e-01f);
  p = p * s + splat(7.967215516e-01f);
  return splat(0.5f) + z * p;
}

void activate_with_slope(float* x, int64_t rows, int64_t blocks, float* slope) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + blocks * kBlock; i += kLanes<float>) {
      const Float value = load(x + i), z = limited(value);
      store(slope + i, gelu_slope(z));
      store(x + i, gelu(value, z));
    }
  }
}

void activate(float* x, int64_t rows, int64_t blocks) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + blocks * kBlock; i += kLanes<float>) {
      store(x + i, gelu(load(x + i)));
    }
  }
}

void activate_sum(const float* a, const float* b, int64_t count, float* out) {
  int64_t i = 0;
  for (; i + kLanes<float> <= count; i += kLanes<float>) {
    store(out + i, gelu(load(a + i) + load(b + i)));
  }
  for (; i < count; ++i) out[i] = gelu(splat(a[i] + b[i]))[0];
}

/// With the number of inputs known, so that the inner loop unrolls and the weights of a vector stay
/// in registers for all pairs.
template <int INPUTS>
void hidden_rows(const PairGeometry& geometry, const float* weight, int64_t H, uint32_t* out) {
  const int64_t pairs = geometry.pairs, stride = hidden_pairs(H), width = 2 * stride;
  for (int64_t h = 0; h < width; h += kLanes<float>, weight += kLanes<float>) {
    Float w[INPUTS + 1];
#pragma GCC unroll 8
    for (int f = 0; f <= INPUTS; ++f) w[f] = load(weight + f * width);
    for (int64_t i = 0; i < pairs; ++i) {
      Float sum = w[INPUTS];
#pragma GCC unroll 8
      for (int f = 0; f < INPUTS; ++f) {
        sum = sum + splat(geometry.values[f * pairs + i]) * w[f];
      }
      const Halves values = narrow(gelu(sum));
      __builtin_memcpy(out + i * stride + h / 2, &values, sizeof values);
    }
  }
}

void hidden_positions(PairGeometry geometry, const float* weight, int64_t H, uint32_t* out) {
  if (geometry.inputs == kOffsetInputs) {
    hidden_rows<kOffsetInputs>(geometry, weight, H, out);
  } else {
    hidden_rows<kNormalInputs>(geometry, weight, H, out);
  }
}

#if defined(__AMX_BF16__)
/// Positions of `rows` pairs and a few blocks, [rows, blocks * kBlock].
void project(const uint32_t* hidden, int64_t stride, int64_t rows, int64_t b, int64_t blocks,
             const ProjectedPositions<uint32_t, float>& p) {
  amx_multiply({hidden,
                stride,
                blocks * kBlock,
                {nullptr, rows, p.inputs, p.weight + b * p.inputs * kBlock, kBlock,
                 p.inputs * kBlock, p.bias + b * kBlock, blocks, false, p.position}});
}
constexpr int64_t kBlocksAtOnce = kProjectedBlocks;
#else
/// ROWS positions of one block.
template <int ROWS>
void project_rows(const uint32_t* hidden, int64_t stride, int64_t pairs, const uint32_t* weight,
                  const float* bias, float* out) {
  Float sum[ROWS][kVectors];
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) sum[r][v] = load(bias + v * kLanes<float>);
  }
  for (int64_t h = 0; h < pairs; ++h) {
    PairProduct::Weight w[kVectors];
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      w[v] = PairProduct::weight(weight + h * kBlock + v * kLanes<float>);
    }
#pragma GCC unroll 16
    for (int r = 0; r < ROWS; ++r) {
      const PairProduct::Spread x = PairProduct::spread(hidden[r * stride + h]);
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) sum[r][v] = PairProduct::add(sum[r][v], x, w[v]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) store(out + r * kBlock + v * kLanes<float>, sum[r][v]);
  }
}

constexpr int64_t kBlocksAtOnce = 1;
/// Positions of `rows` pairs, [rows, kBlock].
void project(const uint32_t* hidden, int64_t stride, int64_t rows, int64_t b, int64_t /*blocks*/,
             const ProjectedPositions<uint32_t, float>& p) {
  constexpr int kProjected = kVectors == 1 ? 16 : kVectors == 2 ? 4 : 2;
  for (int64_t r = 0; r < rows; r += kProjected) {
    project_rows<kProjected>(hidden + r * stride, stride, p.inputs,
                             p.weight + b * p.inputs * kBlock, p.bias + b * kBlock,
                             p.position + r * kBlock);
  }
}
#endif

void projected_sums(NeighbourTable<float> near, ProjectedPositions<uint32_t, float> p, float* out) {
  const int64_t run = near.layers * kPair, stride = near.blocks * run;
  const int64_t rows = (near.K + kBlock - 1) / kBlock * kBlock;
  for (int64_t b = 0; b < near.blocks; b += kBlocksAtOnce) {
    const int64_t blocks = b + kBlocksAtOnce < near.blocks ? kBlocksAtOnce : near.blocks - b;
    for (int64_t first = 0; first < near.queries; first += kProjectedQueries) {
      const int64_t left = near.queries - first;
      const int64_t count = left < kProjectedQueries ? left : kProjectedQueries;
      project(p.hidden + first * rows * p.stride, p.stride, count * rows, b, blocks, p);
      for (int64_t i = 0; i < count; ++i) {
        const int64_t q = first + i;
        for (int64_t c = 0; c < blocks; ++c) {
          sum_query(near.table + (b + c) * run, near.stride, near.layers, near.index + q * near.K,
                    near.K, p.position + (i * rows * blocks + c) * kBlock, blocks * kBlock,
                    out + q * stride + (b + c) * run);
        }
      }
    }
  }
}

}  // namespace

extern const Bf16Kernels kBf16Kernels;
const Bf16Kernels kBf16Kernels{multiply,         multiply_pairs,      multiply_transposed,
                               pair_rows,        transpose,           attention_gradient,
                               activate,         activate_with_slope, activate_sum,
                               hidden_positions, projected_sums};

}  // namespace lte::ops::LTE_ISA
