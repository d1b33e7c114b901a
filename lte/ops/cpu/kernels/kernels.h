// The inner loops of the CPU operators, built once for every instruction set that pays and chosen
// at run time.
//
// Loops over points never contract a multiplication and an addition into one rounding, so their
// distances are those of a plain loop, bit for bit, on every instruction set. Sums over neighbours
// may contract.
#pragma once

#include <cstdint>

#include "lte/ops/cache_weights.h"

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

/// Positions along space-filling curves.
struct CurveKernels {
  /// curve_code() of serialize_kernel.h of `count` cells [count, 3], bit for bit.
  void (*codes)(const int32_t* cells, int64_t count, bool hilbert, bool transposed, int bits,
                int64_t* out);
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
  /// sums() of positions that exist for one query and block at a time: P = bias + Σ_h hidden[h]
  /// weight[b][h], `weight` [blocks, H, kBlock]. `hidden` holds [H, rows] of each query, rows being
  /// K rounded up to a multiple of kBlock; `position` has room for [rows, kBlock].
  void (*projected_sums)(const T* table, int64_t blocks, int64_t layers, const int64_t* index,
                         int64_t queries, int64_t K, const T* hidden, int64_t H, const T* weight,
                         const T* bias, T* position, T* out);
};

/// Floats from one row of a tile to the next. Wider rows continue in further panels of the tile.
inline constexpr int64_t kPanel = 128;
/// LayerNorm's, as LibTorch's default.
inline constexpr float kNormEpsilon = 1e-5f;

/// Dense layers on tiles of rows, float32. Each row's result is the same bits whatever rows there
/// are besides.
struct DenseKernels {
  /// out[r] (+)= bias + Σ_k x[r][k] w[k] over `blocks` blocks of columns, K <= kPanel; without
  /// `bias`, 0. Weights of block b and input k start at weight + b * block_stride + k * row_stride.
  void (*multiply)(const float* x, int64_t rows, int64_t K, const float* weight, int64_t row_stride,
                   int64_t block_stride, const float* bias, int64_t blocks, bool add, float* out);
  /// x = GELU(x), the exact form, to 10^-6.
  void (*activate)(float* x, int64_t rows, int64_t blocks);
  /// out = GELU(x), and out = grad ⊙ GELU'(x), over `count` columns of one row.
  void (*activate_row)(const float* x, int64_t count, float* out);
  void (*activate_gradient)(const float* x, const float* grad, int64_t count, float* out);
  /// out = GELU(a + b) over `count` columns of one row.
  void (*activate_sum)(const float* a, const float* b, int64_t count, float* out);
  /// out = max(out, x), and out += x, over `count` columns of one row.
  void (*maximize)(const float* x, int64_t count, float* out);
  void (*accumulate)(const float* x, int64_t count, float* out);
  /// Norm over the channels of each row. Columns past `channels`, to a whole block, are zero, and
  /// gain and bias too.
  void (*layer_norm)(const float* x, int64_t rows, int64_t panel_stride, int64_t channels,
                     const float* gain, const float* bias, float* out);
  /// x = exp(x − the row's largest) over the first `count` columns of each row; inverse_sum[r]: one
  /// over the sum of row r.
  void (*exponentiate)(float* x, int64_t rows, int64_t panel_stride, int64_t count,
                       float* inverse_sum);
  /// out = (query ⊙ S1 + S2) * scale. S1 and S2 of row r and block b: sums + r * row_stride + b *
  /// block_stride, S2 kBlock further.
  void (*attend)(const float* query, int64_t rows, int64_t blocks, const float* sums,
                 int64_t row_stride, int64_t block_stride, float scale, float* out);
  /// GELU of a layer 3 -> H, transposed: offset [3, pairs] -> out [H, pairs]; weight [H, 4], the
  /// bias last; `pairs` a multiple of kBlock.
  void (*hidden_positions)(const float* offset, int64_t pairs, const float* weight, int64_t H,
                           float* out);
};

/// Products of bfloat16 operands with sums in float32. Two inputs make a pair, the even one in the
/// lower half. Inputs are rounded to the nearest even; where the processor has no bfloat16
/// instructions the same is computed from float32 ones.
struct Bf16Kernels {
  /// DenseKernels::multiply() with pairs of weights: strides count pairs, and that of K is (K + 1)
  /// /
  /// 2. The partner of an odd last input must be zero in `weight`.
  void (*multiply)(const float* x, int64_t rows, int64_t K, const uint32_t* weight,
                   int64_t row_stride, int64_t block_stride, const float* bias, int64_t blocks,
                   bool add, float* out);
  /// out[r][c] (+)= Σ_k left[k][r] right[k][c] over `pairs` pairs, `rows` <= kPanel and `blocks`
  /// blocks of columns: the product of two matrices whose rows are what is summed over. All strides
  /// are kPanel.
  void (*multiply_transposed)(const uint32_t* left, int64_t rows, int64_t pairs,
                              const uint32_t* right, int64_t blocks, bool add, float* out);
  /// Two rows of `count` values as pairs, the even one in the lower half; without `odd`, zeros
  /// there.
  void (*pair_rows)(const float* even, const float* odd, int64_t count, uint32_t* out);
  /// As of DenseKernels, for what a product of bfloat16 reads next: GELU to 2 · 10^-4, a tenth of a
  /// rounding.
  void (*activate)(float* x, int64_t rows, int64_t blocks);
  void (*activate_sum)(const float* a, const float* b, int64_t count, float* out);
  /// DenseKernels::hidden_positions() in pairs of h: [(H + 1) / 2, pairs].
  void (*hidden_positions)(const float* offset, int64_t pairs, const float* weight, int64_t H,
                           uint32_t* out);
  /// SumKernels::projected_sums() with `pairs` pairs of hidden activations and weights.
  void (*projected_sums)(const float* table, int64_t blocks, int64_t layers, const int64_t* index,
                         int64_t queries, int64_t K, const uint32_t* hidden, int64_t pairs,
                         const uint32_t* weight, const float* bias, float* position, float* out);
};

/// Weighted means over a query's neighbours (lte/ops/irradiance_cache.h).
struct CacheKernels {
  static constexpr int64_t kMostNeighbours = 64;
  /// Of `queries` queries with `K` <= kMostNeighbours neighbours each: what
  /// irradiance_cache_means() returns. Arrays as of its arguments; position, normal and index begin
  /// at the first query.
  void (*means)(const float* points, const float* normals, const float* light, const int64_t* index,
                int64_t queries, int64_t K, const float* position, const float* normal,
                const CacheWeights& weights, float* out);
};

/// Of the best instruction set that the processor has: avx512 (for bfloat16: avx512_bf16), avx2 or
/// baseline. The environment variable LTE_CPU_ISA names a lesser one, for tests; read once.
const PointKernels& point_kernels();
const CurveKernels& curve_kernels();
const DenseKernels& dense_kernels();
const Bf16Kernels& bf16_kernels();
const CacheKernels& cache_kernels();
template <typename T>
const SumKernels<T>& sum_kernels();
const char* cpu_isa();

}  // namespace lte::ops
