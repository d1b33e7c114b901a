// The inner loops of the CPU operators, built once for every instruction set that pays and chosen
// at run time.
//
// Loops over points never contract a multiplication and an addition into one rounding, so their
// distances are those of a plain loop, bit for bit, on every instruction set. Sums over neighbours
// may contract.
#pragma once

#include <cstdint>

namespace lte::ops {

/// Channels of one block of the interleaved layout below.
inline constexpr int64_t kBlock = 16;

/// Over points in coordinate arrays that may be read up to 16 entries past `count`.
struct PointKernels {
  /// out[i] = (dx² + dy²) + dz²; `out` too has room for 16 more.
  void (*distances)(const float* x, const float* y, const float* z, int64_t count,
                    const float* point, float* out);
  /// Positions i with value[i] <= bound, ascending; returns how many. `out` has room for count
  /// + 16.
  int64_t (*select)(const float* value, int64_t count, float bound, int32_t* out);
  /// rank[i]: how many (value, id) precede that of i. All three arrays have room for 16 more.
  void (*ranks)(const float* value, const int32_t* id, int64_t count, int32_t* rank);
  /// distance[i] = min(distance[i], squared distance to the point). Returns the largest afterwards,
  /// and the first position that has it.
  float (*relax)(const float* x, const float* y, const float* z, int64_t count, const float* point,
                 float* distance, int64_t* farthest);
  /// Boxes that are nearer to the point than `reach`, ascending; returns how many. `box` holds the
  /// arrays of low x, y, z and high x, y, z, each `stride` long.
  int64_t (*reached)(const float* box, int64_t stride, int64_t count, const float* point,
                     const float* reach, int32_t* out);
};

/// Sums over neighbours. A pair of [L, n, C] tensors is held interleaved as [n, blocks, L, 2,
/// kBlock], C padded with zeros to blocks * kBlock: what one query reads of one latent for a block
/// of channels is one run of memory for all layers, so that a position is loaded once for all of
/// them and the accumulators of six layers stay in registers.
template <typename T>
struct SumKernels {
  /// out[q] = {Σ (v + P), Σ (P − k) ⊙ (v + P)} over the K neighbours of each of `queries`; `table`
  /// holds (k, v). P of query q, neighbour i and block b starts at position + (q * K + i) *
  /// row_stride + b * block_stride.
  void (*sums)(const T* table, int64_t blocks, int64_t layers, const int64_t* index,
               int64_t queries, int64_t K, const T* position, int64_t row_stride,
               int64_t block_stride, T* out);
  /// Gradient by P, [rows, blocks * kBlock]: Σ_layers g1 + g2 ⊙ (v − k + 2 P), from `grad` (g1, g2)
  /// of the queries.
  void (*position_gradient)(const T* table, const T* grad, int64_t blocks, int64_t layers,
                            const int64_t* index, int64_t queries, int64_t K, const T* position,
                            T* out);
  /// Gradient by (k, v) of one latent, [blocks, L, 2, kBlock], from the rows q * K + i that read
  /// it. `position` is [rows, blocks * kBlock], `entry` the latent's own row of the table.
  void (*table_gradient)(const T* entry, const T* grad, int64_t blocks, int64_t layers,
                         const int32_t* rows, int64_t count, int64_t K, const T* position, T* out);
  /// out[b][r] = bias_b + Σ_h hidden[r][h] weight[b][h], blocks of [kBlock] channels.
  void (*project)(const T* hidden, int64_t rows, int64_t H, const T* weight, const T* bias,
                  int64_t blocks, T* out);
};

/// Of the best instruction set that the processor has: avx512, avx2 or baseline. The environment
/// variable LTE_CPU_ISA names a lesser one, for tests; read once.
const PointKernels& point_kernels();
template <typename T>
const SumKernels<T>& sum_kernels();
const char* cpu_isa();

}  // namespace lte::ops
