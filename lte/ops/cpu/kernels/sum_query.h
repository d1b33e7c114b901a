// The sums over neighbours of one query in the interleaved layout of kernels.h.
//
// Only kernel files include this.
#pragma once

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {

/// Layers whose accumulators, two vectors each, fit the registers.
inline constexpr int kSumGroup = 6;
inline constexpr int64_t kPair = 2 * kBlock;

/// One query, one run of lanes, layers [0, LAYERS) from `table`.
template <typename T, int LAYERS>
void sum_group(const T* table, int64_t stride, const int64_t* index, int64_t K, const T* position,
               int64_t row_stride, T* out) {
  Vector<T> s1[LAYERS] = {}, s2[LAYERS] = {};
  for (int64_t i = 0; i < K; ++i) {
    const T* entry = table + index[i] * stride;
    const Vector<T> p = load(position + i * row_stride);
#pragma GCC unroll 8
    for (int l = 0; l < LAYERS; ++l) {
      const Vector<T> value = load(entry + l * kPair + kBlock) + p;
      s1[l] += value;
      s2[l] += (p - load(entry + l * kPair)) * value;
    }
  }
#pragma GCC unroll 8
  for (int l = 0; l < LAYERS; ++l) {
    store(out + l * kPair, s1[l]);
    store(out + l * kPair + kBlock, s2[l]);
  }
}

template <typename T>
using SumGroup = void (*)(const T*, int64_t, const int64_t*, int64_t, const T*, int64_t, T*);
template <typename T>
constexpr SumGroup<T> kSumGroups[kSumGroup + 1] = {
    nullptr,         sum_group<T, 1>, sum_group<T, 2>, sum_group<T, 3>,
    sum_group<T, 4>, sum_group<T, 5>, sum_group<T, 6>};

/// One query, one block, all layers.
template <typename T>
void sum_query(const T* table, int64_t stride, int64_t layers, const int64_t* index, int64_t K,
               const T* position, int64_t row_stride, T* out) {
  for (int64_t l = 0; l < layers; l += kSumGroup) {
    const int64_t group = layers - l < kSumGroup ? layers - l : kSumGroup;
    for (int64_t lane = 0; lane < kBlock; lane += kLanes<T>) {
      kSumGroups<T>[group](table + l * kPair + lane, stride, index, K, position + lane, row_stride,
                           out + l * kPair + lane);
    }
  }
}

}  // namespace lte::ops::LTE_ISA
