// Rows that become columns, by blocks of 16 × 16 that fit the registers.
//
// Only kernel files include this.
#pragma once

#include <cstdint>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {

/// to[c][r] = finish(from[r][c]) of kBlock × kBlock numbers of 32 bits; rows past `rows` are zero.
/// `finish` takes a vector of them.
template <typename T, typename Finish>
inline void transpose_block(const T* from, int64_t stride, int64_t rows, T* to, int64_t to_stride,
                            const Finish& finish) {
#if defined(__AVX512F__)
  // Rows are zipped four times with those eight further, by which an element's place (row, column),
  // eight bits, turns by half.
  constexpr int kSide = static_cast<int>(kBlock), kHalf = kSide / 2;
  Vector<T> at[kSide], zipped[kSide];
#pragma GCC unroll 16
  for (int i = 0; i < kSide; ++i) at[i] = i < rows ? load(from + i * stride) : Vector<T>{};
#pragma GCC unroll 4
  for (int round = 0; round < 4; ++round) {
#pragma GCC unroll 8
    for (int i = 0; i < kHalf; ++i) {
      const Vector<T>&a = at[i], &b = at[i + kHalf];
      zipped[2 * i] =
          __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
      zipped[2 * i + 1] = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13,
                                                  29, 14, 30, 15, 31);
    }
#pragma GCC unroll 16
    for (int i = 0; i < kSide; ++i) at[i] = zipped[i];
  }
#pragma GCC unroll 16
  for (int i = 0; i < kSide; ++i) store(to + i * to_stride, finish(at[i]));
#else
  for (int64_t c = 0; c < kBlock; ++c) {
    T* row = to + c * to_stride;
    for (int64_t r = 0; r < kBlock; ++r) row[r] = r < rows ? from[r * stride + c] : T{};
    for (int64_t r = 0; r < kBlock; r += kLanes<T>) store(row + r, finish(load(row + r)));
  }
#endif
}

/// TransposedRows, of which `rows` are kBlock at most.
template <typename T, typename Finish>
inline void transpose_rows(TransposedRows<T> r, const Finish& finish) {
  int64_t c = 0;
  for (; c + kBlock <= r.columns; c += kBlock)
    transpose_block(r.from + c, r.stride, r.rows, r.to + c * r.to_stride, r.to_stride, finish);
  if (c == r.columns) return;
  T block[kBlock * kBlock] = {}, turned[kBlock * kBlock];  // the last columns alone are there
  for (int64_t i = 0; i < r.rows; ++i) {
    for (int64_t k = c; k < r.columns; ++k) block[i * kBlock + k - c] = r.from[i * r.stride + k];
  }
  transpose_block(block, kBlock, r.rows, turned, kBlock, finish);
  for (int64_t k = c; k < r.columns; ++k) {
    for (int64_t i = 0; i < kBlock; ++i) r.to[k * r.to_stride + i] = turned[(k - c) * kBlock + i];
  }
}

}  // namespace lte::ops::LTE_ISA
