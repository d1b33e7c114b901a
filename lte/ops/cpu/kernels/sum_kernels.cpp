// Sums over neighbours in the interleaved layout of kernels.h, and the small matrix product that
// feeds them.
//
// All of them are bound by reads of the table, so each loop is arranged to read an entry once: a
// block of channels outside and queries inside, so that queries near each other find the entries of
// their common neighbours in the first-level cache; all layers of an entry in one go, as many as
// have accumulators in the registers; and a row of lanes at a time.
#include <algorithm>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/sum_query.h"
#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {
namespace {

/// Layers whose accumulators, three vectors each, fit the registers.
constexpr int kGradientGroup = kVectorBytes == 64 ? 6 : 3;

template <typename T>
void sums(NeighbourTable<T> near, Positions<T> p, T* out) {
  const int64_t run = near.layers * kPair, stride = near.blocks * run;
  for (int64_t b = 0; b < near.blocks; ++b) {
    for (int64_t q = 0; q < near.queries; ++q) {
      sum_query(near.table + b * run, near.stride, near.layers, near.index + q * near.K, near.K,
                p.values + q * near.K * p.row_stride + b * p.block_stride, p.row_stride,
                out + q * stride + b * run);
    }
  }
}

/// With g1 and g2 summed over the layers outside the loop over neighbours: Σ g1 + 2 P ⊙ Σ g2 is one
/// multiplication, and what is left of each layer is g2 ⊙ (v − k).
template <typename T>
void position_gradient(NeighbourTable<T> near, const T* grad, const T* position, T* out) {
  const auto [table, table_stride, blocks, layers, index, queries, K] = near;
  const int64_t run = layers * kPair, stride = blocks * run, row_stride = blocks * kBlock;
  for (int64_t b = 0; b < blocks; ++b) {
    for (int64_t q = 0; q < queries; ++q) {
      for (int64_t lane = 0; lane < kBlock; lane += kLanes<T>) {
        const T* g = grad + q * stride + b * run + lane;
        Vector<T> g1{}, g2{};
        for (int64_t l = 0; l < layers; ++l) {
          g1 += load(g + l * kPair);
          g2 += load(g + l * kPair + kBlock);
        }
        g2 += g2;
        for (int64_t i = 0; i < K; ++i) {
          const int64_t row = (q * K + i) * row_stride + b * kBlock + lane;
          const T* entry = table + index[q * K + i] * table_stride + b * run + lane;
          Vector<T> sum = g1 + g2 * load(position + row);
          for (int64_t l = 0; l < layers; ++l) {
            sum += load(g + l * kPair + kBlock) *
                   (load(entry + l * kPair + kBlock) - load(entry + l * kPair));
          }
          store(out + row, sum);
        }
      }
    }
  }
}

/// With A1 = Σ g1, A2 = Σ g2 and B = Σ g2 ⊙ P over the rows that read the latent, its gradients are
/// dk = −(A2 ⊙ v + B) and dv = A1 + B − A2 ⊙ k: k and v themselves are read once.
template <typename T, int LAYERS>
void gradient_group(const T* entry, const T* grad, int64_t stride, const int32_t* rows,
                    int64_t count, int32_t K, const T* position, int64_t row_stride, bool add,
                    T* out) {
  Vector<T> a1[LAYERS] = {}, a2[LAYERS] = {}, b[LAYERS] = {};
  for (int64_t i = 0; i < count; ++i) {
    const T* g = grad + rows[i] / K * stride;
    const Vector<T> p = load(position + rows[i] * row_stride);
#pragma GCC unroll 8
    for (int l = 0; l < LAYERS; ++l) {
      const Vector<T> g2 = load(g + l * kPair + kBlock);
      a1[l] += load(g + l * kPair);
      a2[l] += g2;
      b[l] += g2 * p;
    }
  }
#pragma GCC unroll 8
  for (int l = 0; l < LAYERS; ++l) {
    const Vector<T> k = load(entry + l * kPair), v = load(entry + l * kPair + kBlock);
    const Vector<T> by_k = -(a2[l] * v + b[l]), by_v = a1[l] + b[l] - a2[l] * k;
    T *to_k = out + l * kPair, *to_v = to_k + kBlock;
    store(to_k, add ? load(to_k) + by_k : by_k);
    store(to_v, add ? load(to_v) + by_v : by_v);
  }
}

template <typename T>
using GradientGroup = void (*)(const T*, const T*, int64_t, const int32_t*, int64_t, int32_t,
                               const T*, int64_t, bool, T*);
template <typename T>
constexpr GradientGroup<T> kGradientGroups[7] = {nullptr,
                                                 gradient_group<T, 1>,
                                                 gradient_group<T, 2>,
                                                 gradient_group<T, 3>,
                                                 gradient_group<T, 4>,
                                                 gradient_group<T, 5>,
                                                 gradient_group<T, 6>};

template <typename T>
void table_gradient(LatentGradient<T> latent, T* out) {
  const auto [entry, grad, blocks, layers, rows, count, K, position, add] = latent;
  const int64_t run = layers * kPair;
  for (int64_t b = 0; b < blocks; ++b) {
    for (int64_t l = 0; l < layers; l += kGradientGroup) {
      const int64_t group = layers - l < kGradientGroup ? layers - l : kGradientGroup;
      for (int64_t lane = 0; lane < kBlock; lane += kLanes<T>) {
        const int64_t at = b * run + l * kPair + lane;
        kGradientGroups<T>[group](entry + at, grad + at, blocks * run, rows, count,
                                  static_cast<int32_t>(K), position + b * kBlock + lane,
                                  blocks * kBlock, add, out + at);
      }
    }
  }
}

/// ROWS positions of BLOCKS blocks from the transposed activations [H, stride]. Blocks of weights
/// are H * kBlock apart, those of positions `out_stride`.
template <typename T, int ROWS, int BLOCKS>
void project_rows(const T* hidden, int64_t stride, int64_t H, const T* weight, const T* bias,
                  T* out, int64_t out_stride) {
  constexpr int kOfBlock = kBlock / kLanes<T>, kVectors = BLOCKS * kOfBlock;
  Vector<T> sum[ROWS][kVectors];
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) sum[r][v] = load(bias + v * kLanes<T>);
  }
  for (int64_t h = 0; h < H; ++h) {
    Vector<T> w[kVectors];
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      w[v] = load(weight + v / kOfBlock * H * kBlock + h * kBlock + v % kOfBlock * kLanes<T>);
    }
#pragma GCC unroll 16
    for (int r = 0; r < ROWS; ++r) {
      const Vector<T> x = splat(hidden[h * stride + r]);
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) sum[r][v] += x * w[v];
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < ROWS; ++r) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      store(out + v / kOfBlock * out_stride + r * kBlock + v % kOfBlock * kLanes<T>, sum[r][v]);
    }
  }
}

/// projected_sums() of blocks [b, b + BLOCKS).
template <typename T, int ROWS, int BLOCKS>
void project_and_sum(const NeighbourTable<T>& near, const ProjectedPositions<T, T>& p, int64_t b,
                     T* out) {
  const int64_t run = near.layers * kPair, stride = near.blocks * run;
  const int64_t rows = (near.K + kBlock - 1) / kBlock * kBlock;
  for (int64_t first = 0; first < near.queries; first += kProjectedQueries) {
    const int64_t end = std::min(first + kProjectedQueries, near.queries);
    T* position = p.position;
    for (int64_t q = first; q < end; ++q, position += BLOCKS * rows * kBlock) {
      for (int64_t r = 0; r < rows; r += ROWS) {
        project_rows<T, ROWS, BLOCKS>(p.hidden + q * p.inputs * rows + r, rows, p.inputs,
                                      p.weight + b * p.inputs * kBlock, p.bias + b * kBlock,
                                      position + r * kBlock, rows * kBlock);
      }
    }
    position = p.position;
    for (int64_t q = first; q < end; ++q) {
      for (int64_t i = 0; i < BLOCKS; ++i, position += rows * kBlock) {
        sum_query(near.table + (b + i) * run, near.stride, near.layers, near.index + q * near.K,
                  near.K, position, kBlock, out + q * stride + (b + i) * run);
      }
    }
  }
}

template <typename T>
void projected_sums(NeighbourTable<T> near, ProjectedPositions<T, T> p, T* out) {
  constexpr int kVectors = kBlock / kLanes<T>;
  // Where a block is one vector, two share each hidden activation that is read.
  constexpr int kBlocks = kVectors == 1 ? kProjectedBlocks : 1;
  constexpr int kRows = kVectors == 1 ? 8 : kVectors == 2 ? 4 : 2;
  int64_t b = 0;
  for (; b + kBlocks <= near.blocks; b += kBlocks) {
    project_and_sum<T, kRows, kBlocks>(near, p, b, out);
  }
  for (; b < near.blocks; ++b) project_and_sum<T, kRows, 1>(near, p, b, out);
}

}  // namespace

extern const SumKernels<float> kFloatSums;
extern const SumKernels<double> kDoubleSums;
const SumKernels<float> kFloatSums{sums<float>, position_gradient<float>, table_gradient<float>,
                                   projected_sums<float>};
const SumKernels<double> kDoubleSums{sums<double>, position_gradient<double>,
                                     table_gradient<double>, projected_sums<double>};

}  // namespace lte::ops::LTE_ISA
