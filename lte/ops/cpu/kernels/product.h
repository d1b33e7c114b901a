// The matrix product of the dense kernels: sums of some rows and blocks of columns stay in the
// registers while the inputs pass by, one float32 or one pair of bfloat16 at a time.
//
// Only kernel files include this.
#pragma once

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

#if defined(__AVX512BF16__)
#include <immintrin.h>
#endif

namespace lte::ops::LTE_ISA {

using Float = Vector<float>;
using Bits = Vector<uint32_t>;
/// Vectors of one block of channels.
inline constexpr int kVectors = static_cast<int>(kBlock) / kLanes<float>;
/// Rows and blocks of columns whose sums stay in the registers: 24 of 32, or 12 or 8 of 16.
inline constexpr int kRows = kVectors == 1 ? 12 : kVectors == 2 ? 6 : 2;
inline constexpr int kColumns = kVectors == 1 ? 2 : 1;

struct SingleProduct {
  using Scalar = float;  ///< of one row: an input
  using Spread = Float;  ///< the same in all lanes
  using Weight = Float;  ///< of as many outputs as there are lanes
  static constexpr int64_t kRowStride = kPanel, kInputStride = 1;

  static Spread spread(Scalar x) { return splat(x); }
  static Weight weight(const Scalar* w) { return load(w); }
  static Float add(const Float& sum, const Spread& x, const Weight& w) { return sum + x * w; }
};

/// Two inputs at a time, the even one in the lower half of a scalar. Products of bfloat16 are exact
/// in float32; the odd input is added first, as the instruction does.
struct PairProduct {
  using Scalar = uint32_t;
  static constexpr int64_t kRowStride = kPanel / 2, kInputStride = 1;

#if defined(__AVX512BF16__)
  using Spread = Bits;
  using Weight = Bits;
  static Spread spread(Scalar x) { return splat(x); }
  static Weight weight(const Scalar* w) { return load(w); }
  static Float add(const Float& sum, const Spread& x, const Weight& w) {
    return (Float)_mm512_dpbf16_ps((__m512)sum, (__m512bh)x, (__m512bh)w);
  }
#else
  struct Halves {
    Float low, high;
  };
  using Spread = Halves;
  using Weight = Halves;
  static Spread spread(Scalar x) { return halves(splat(x)); }
  static Weight weight(const Scalar* w) { return halves(load(w)); }
  static Float add(const Float& sum, const Spread& x, const Weight& w) {
    return (sum + x.high * w.high) + x.low * w.low;
  }

 private:
  static Halves halves(const Bits& pair) {
    return {(Float)(pair << 16), (Float)(pair & splat(uint32_t{0xffff0000}))};
  }
#endif
};

/// The same with rows of x that lie as columns.
struct TransposedPairProduct : PairProduct {
  static constexpr int64_t kRowStride = 1, kInputStride = kPanel;
};

template <typename Product, int ROWS, int BLOCKS>
void multiply_rows(const typename Product::Scalar* x, int64_t K,
                   const typename Product::Scalar* weight, int64_t row_stride, int64_t block_stride,
                   const float* bias, bool add, float* out) {
  constexpr int kCount = BLOCKS * kVectors;
  Float sum[ROWS][kCount];
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kCount; ++v) {
      sum[r][v] = bias != nullptr ? load(bias + v * kLanes<float>) : Float{};
    }
  }
  for (int64_t k = 0; k < K; ++k) {
    typename Product::Weight w[kCount];
#pragma GCC unroll 8
    for (int v = 0; v < kCount; ++v) {
      w[v] = Product::weight(weight + k * row_stride + v / kVectors * block_stride +
                             v % kVectors * kLanes<float>);
    }
#pragma GCC unroll 16
    for (int r = 0; r < ROWS; ++r) {
      const typename Product::Spread value =
          Product::spread(x[r * Product::kRowStride + k * Product::kInputStride]);
#pragma GCC unroll 8
      for (int v = 0; v < kCount; ++v) sum[r][v] = Product::add(sum[r][v], value, w[v]);
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kCount; ++v) {
      float* to = out + r * kPanel + v * kLanes<float>;
      store(to, add ? load(to) + sum[r][v] : sum[r][v]);
    }
  }
}

template <typename Scalar>
using MultiplyRows = void (*)(const Scalar*, int64_t, const Scalar*, int64_t, int64_t, const float*,
                              bool, float*);
/// `count` rows; more than kRows are never asked for.
template <typename P, int BLOCKS, int COUNT>
constexpr MultiplyRows<typename P::Scalar> kMultiplyRows =
    multiply_rows<P, (COUNT <= kRows ? COUNT : 1), BLOCKS>;
template <typename P, int BLOCKS>
constexpr MultiplyRows<typename P::Scalar> kMultiply[13] = {nullptr,
                                                            kMultiplyRows<P, BLOCKS, 1>,
                                                            kMultiplyRows<P, BLOCKS, 2>,
                                                            kMultiplyRows<P, BLOCKS, 3>,
                                                            kMultiplyRows<P, BLOCKS, 4>,
                                                            kMultiplyRows<P, BLOCKS, 5>,
                                                            kMultiplyRows<P, BLOCKS, 6>,
                                                            kMultiplyRows<P, BLOCKS, 7>,
                                                            kMultiplyRows<P, BLOCKS, 8>,
                                                            kMultiplyRows<P, BLOCKS, 9>,
                                                            kMultiplyRows<P, BLOCKS, 10>,
                                                            kMultiplyRows<P, BLOCKS, 11>,
                                                            kMultiplyRows<P, BLOCKS, 12>};

/// DenseKernels::multiply() of float32, or of pairs that `K` and the strides count.
template <typename Product>
void multiply_blocks(MatrixProduct<typename Product::Scalar, typename Product::Scalar> p) {
  for (int64_t b = 0; b < p.blocks; b += kColumns) {
    const bool whole = b + kColumns <= p.blocks;
    const auto* w = p.weight + b * p.block_stride;
    const float* offset = p.bias != nullptr ? p.bias + b * kBlock : nullptr;
    for (int64_t r = 0; r < p.rows; r += kRows) {
      const int64_t count = p.rows - r < kRows ? p.rows - r : kRows;
      const auto function =
          whole ? kMultiply<Product, kColumns>[count] : kMultiply<Product, 1>[count];
      function(p.x + r * Product::kRowStride, p.K, w, p.row_stride, p.block_stride, offset, p.add,
               p.out + r * kPanel + b * kBlock);
    }
  }
}

}  // namespace lte::ops::LTE_ISA
