// The inner loops of the CPU operators, built once for every instruction set that pays and chosen
// at run time.
//
// Loops over points never contract a multiplication and an addition into one rounding, so their
// distances are those of a plain loop, bit for bit, on every instruction set. Sums over neighbours
// may contract.
//
// Why not oneDNN: it chooses its blocking by the whole product's shape, so that a row's last bits
// may depend on how many rows go with it; and its products cannot stop between tiles to sum over
// neighbours or to take a maximum, which is what keeps everything in the caches here.
//
// Kernels take their arguments as plain structs by value: the address of a copy is known to nobody,
// so no store can be thought to change a stride in the middle of a loop.
#pragma once

#include <cstdint>

#include "lte/ops/pair_geometry.h"
#include "lte/ops/prior_columns.h"
#include "lte/ops/surfel_columns.h"

namespace lte::ops {

/// Channels of one block of the interleaved layout below.
inline constexpr int64_t kBlock = 16;

/// Boxes around runs of points: of low x, y, z and high x, y, z an array each, `stride` long, that
/// may be read up to 16 entries past `count`.
struct BoxLevel {
  const float* box;
  int64_t stride, count;
};

/// Points in leaves, and levels of boxes over these: a box of level l + 1 is around kBoxesOfOne
/// boxes of level l, one after the other, those of level 0 are the leaves'. The last level has
/// kBoxesOfOne at most.
struct PointBoxes {
  static constexpr int64_t kBoxesOfOne = 16;
  static constexpr int kMaxLevels = 8;  ///< 2^32 leaves
  const float *x, *y, *z;               ///< may be read up to 16 entries past a leaf
  const int32_t *begin, *end;           ///< of each leaf among the points
  BoxLevel level[kMaxLevels];
  int levels;  ///< at least 1
};

/// Loops over points in coordinate arrays that may be read up to 16 entries past `count`.
struct PointKernels {
  /// out[i] = (dx² + dy²) + dz²; `out` too has room for 16 more.
  void (*distances)(const float* x, const float* y, const float* z, int64_t count,
                    const float* point, float* out);
  /// The largest of distances(); 0 of none.
  float (*farthest)(const float* x, const float* y, const float* z, int64_t count,
                    const float* point);
  /// Points within the squared distance `bound`: their squared distances, as distances() has them,
  /// and where they are. Returns how many; both have room for all points and 16 more.
  int64_t (*near)(const float* x, const float* y, const float* z, int64_t count, const float* point,
                  float bound, float* distance, int32_t* position);
  /// The same among the points of leaves, in no order.
  int64_t (*within)(PointBoxes points, const float* point, float bound, float* distance,
                    int32_t* position);
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
  /// The curve_code() (lte/ops/curve_codes_kernel.h) of `count` cells [count, 3], bit for bit.
  void (*codes)(const int32_t* cells, int64_t count, bool hilbert, bool transposed, int bits,
                int64_t* out);
};

/// Some queries, and the table of what they read of their neighbours.
///
/// A pair of [L, n, C] tensors is held interleaved as [n, blocks, L, 2, kBlock], C padded with
/// zeros to blocks * kBlock. What one query reads of one latent for a block of channels is one run
/// of memory for all layers, so that a position is loaded once for all of them and the accumulators
/// of six layers stay in registers.
template <typename T>
struct NeighbourTable {
  const T* table;  ///< [m, blocks, layers, 2, kBlock]: (k, v)
  int64_t stride;  ///< from one latent's entry to the next
  int64_t blocks, layers;
  const int64_t* index;  ///< [queries, K], rows of the table
  int64_t queries, K;
};

/// Positions P that exist already: that of query q, neighbour i and block b starts at
/// values + (q * K + i) * row_stride + b * block_stride.
template <typename T>
struct Positions {
  const T* values;
  int64_t row_stride, block_stride;
};

/// Blocks of positions, and queries that have them, that exist at once, at most. Queries near each
/// other read the same latents, which stay in the first-level cache while nothing else is read.
inline constexpr int64_t kProjectedBlocks = 2, kProjectedQueries = 8;

/// Positions that exist for a few queries and a block or two at a time:
/// P = bias + Σ_h hidden[h] weight[b][h]. In bfloat16 `Hidden` are pairs, and `inputs` counts
/// those.
template <typename Hidden, typename T>
struct ProjectedPositions {
  /// Of each query [inputs, rows], rows being K rounded up to whole blocks; in bfloat16 [rows,
  /// stride].
  const Hidden* hidden;
  int64_t stride;  ///< in bfloat16; else not read
  int64_t inputs;
  const Hidden* weight;  ///< [blocks, inputs, kBlock]
  const T* bias;         ///< [blocks, kBlock]
  T* position;           ///< room for [kProjectedQueries, kProjectedBlocks, rows, kBlock]
};

/// What the gradient by one latent's row of the table is made of.
template <typename T>
struct LatentGradient {
  const T* entry;  ///< the latent's own row of the table
  const T* grad;   ///< (g1, g2) of the queries, interleaved
  int64_t blocks, layers;
  const int32_t* rows;  ///< [count], the rows q * K + i that read the latent
  int64_t count, K;
  const T* position;  ///< [rows, blocks * kBlock]
  bool add;           ///< to what the result's place holds
};

/// Sums over neighbours.
template <typename T>
struct SumKernels {
  /// out[q] = {Σ (v + P), Σ (P − k) ⊙ (v + P)} over the neighbours of each query.
  void (*sums)(NeighbourTable<T> near, Positions<T> position, T* out);
  /// Gradient by P, [rows, blocks * kBlock]: Σ_layers g1 + g2 ⊙ (v − k + 2 P), from `grad` (g1, g2)
  /// of the queries, interleaved. `position` is [rows, blocks * kBlock].
  void (*position_gradient)(NeighbourTable<T> near, const T* grad, const T* position, T* out);
  /// Gradient by (k, v) of one latent, [blocks, L, 2, kBlock].
  void (*table_gradient)(LatentGradient<T> latent, T* out);
  /// sums() of positions that never exist all at once.
  void (*projected_sums)(NeighbourTable<T> near, ProjectedPositions<T, T> position, T* out);
};

/// Floats from one row of a tile to the next. Wider rows continue in further panels of the tile.
inline constexpr int64_t kPanel = 128;
/// LayerNorm's epsilon, as LibTorch's default.
inline constexpr float kNormEpsilon = 1e-5f;

/// out[r] (+)= bias + Σ_k x[r][k] w[k] over blocks of columns. In bfloat16 weights are pairs, and
/// the strides count those.
template <typename Input, typename Weight>
struct MatrixProduct {
  const Input* x;  ///< [rows, K], one panel of a tile
  int64_t rows, K;
  const Weight* weight;  ///< of block b and input k: weight + b * block_stride + k * row_stride
  int64_t row_stride, block_stride;
  const float* bias;  ///< [blocks, kBlock], or null: 0
  int64_t blocks;     ///< of columns, kBlock each
  bool add;           ///< to what `out` holds
  float* out;         ///< [rows, blocks * kBlock], one panel of a tile
};

/// Rows that become columns.
template <typename T>
struct TransposedRows {
  const T* from;
  int64_t stride, rows, columns;
  T* to;
  int64_t to_stride;
};

/// out = (query ⊙ S1 + S2) * scale, the vector attention of a panel.
struct AttendArguments {
  const float* query;  ///< [rows, blocks * kBlock], one panel of a tile
  int64_t rows, blocks;
  const float* sums;  ///< S1 of row r and block b: sums + r * row_stride + b * block_stride; S2 is
                      ///< kBlock further
  int64_t row_stride, block_stride;
  float scale;
  float* out;  ///< as `query`, and may be the same
};

/// What γ reads of a query's pairs with its neighbours, [inputs, pairs].
struct PairGeometry {
  const float* values;
  int64_t inputs, pairs;
};

/// Some lobes of a point, and directions that are asked of them.
struct LobeRidges {
  const float* lobes;       ///< x of the axes; y, z and the offsets are `stride` further each
  int64_t stride;           ///< and there are zeros past the last lobe, to a whole block
  const float* directions;  ///< [count, 3]
  int64_t count, blocks;
  float* out;  ///< [count, blocks * kBlock], one panel of a tile
};

/// Dense layers on tiles of rows, float32. Each row's result is the same bits whatever rows there
/// are besides.
struct DenseKernels {
  /// K <= kPanel.
  void (*multiply)(MatrixProduct<float, float> product);
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
  /// x = 2^(x − largest[r]) over the first `count` columns of each row r, whose largest that is;
  /// inverse_sum[r]: one over the sum of row r.
  void (*exponentiate)(float* x, int64_t rows, int64_t panel_stride, int64_t count,
                       float* inverse_sum, float* largest);
  /// The largest Σ x² of a row; not a number if any row is not finite.
  float (*largest_square)(const float* x, int64_t rows, int64_t stride, int64_t columns);
  /// x = 2^x over the first `count` columns of a panel, |x| <= 120; what row r adds up to is added
  /// to the kBlock numbers from sum + r * kBlock, whose sum it is.
  void (*raise)(float* x, int64_t rows, int64_t count, float* sum);
  void (*attend)(AttendArguments arguments);
  /// to[c][r] = factor · from[r][c], `rows` <= kBlock; to's rows are written to a whole block, with
  /// zeros past the last.
  void (*transpose)(TransposedRows<float> rows, float factor);
  /// GELU of a layer F -> H, transposed: geometry [F, pairs] -> out [H, pairs]; weight [H, F + 1],
  /// the bias last; `pairs` a multiple of kBlock.
  void (*hidden_positions)(PairGeometry geometry, const float* weight, int64_t H, float* out);
  /// out = GELU(axis · direction + offset) of each lobe.
  void (*ridges)(LobeRidges lobes);
  /// x = log(1 + exp(x)), softplus, to 10^-6, over the first block of each row of a panel.
  void (*soften)(float* x, int64_t rows);
};

/// A norm over the channels of each row, backwards. Tiles lie as in DenseKernels::layer_norm().
struct LayerNormGradient {
  const float* x;  ///< what was normed
  int64_t rows, panel_stride, channels;
  const float* gain;         ///< zero past the last channel
  const float* grad;         ///< by the norm's result
  float* by_x;               ///< added to
  float *by_gain, *by_bias;  ///< [channels to a whole block], added to
};

/// AttendArguments backwards: `grad` by the result becomes that by the query.
struct AttendGradient {
  const float* query;
  int64_t rows, blocks;
  const float* sums;
  int64_t row_stride, block_stride;
  float scale;
  float* grad;
  float* by_sums;  ///< laid out as `sums`
};

/// The maximum over k pairs of W GELU(dense[neighbour[i]] + center) + b, backwards, for one centre:
/// only the pairs that are the largest of some output have a gradient.
struct MaximumGradient {
  const float *dense, *center;
  const int64_t* neighbour;  ///< [k]
  int64_t k, channels;       ///< channels: whole blocks
  const float* weight;       ///< W, [outputs, channels]
  int64_t outputs;
  const int32_t* winner;                    ///< [outputs], of the k pairs
  const float* grad;                        ///< [outputs]
  float *hidden, *slope, *back;             ///< room for [k, channels] each
  uint8_t* seen;                            ///< room for [k], zero before and after
  float *by_dense, *by_center, *by_weight;  ///< as dense, center and weight; added to
};

/// Weights of attention, and the gradient by its scores, of one panel of keys.
struct AttentionGradient {
  float* scores;  ///< in units of log 2; becomes weights 2^(score − log_sum)
  float* grad;    ///< by the weights; becomes that by the scores in units of e
  int64_t rows, blocks;
  const float* log_sum;  ///< [rows]
  const float* mean;     ///< [rows], Σ weight · grad over all keys
};

/// What products of bfloat16 read of a panel of AttentionGradient, which itself stays as it is.
struct AttentionPairs {
  uint32_t* weights;    ///< [⌈rows / 2⌉, kPanel], pairs of queries
  uint32_t* by_scores;  ///< the same of the gradient by the scores
  uint32_t* by_key;     ///< [rows, kPanel / 2], that gradient in pairs of keys
  int64_t keys;         ///< zero has the partner of an odd last one
};

/// Gradients over tiles of rows, float32. A panel's rows are kPanel apart.
struct GradientKernels {
  /// out[r][c] (+)= bias + Σ_k x[k][r] w[k][c]: DenseKernels::multiply() of an x that lies as
  /// columns, K any.
  void (*multiply_transposed)(MatrixProduct<float, float> product);
  /// x = GELU(x), and the slope there, of one panel each.
  void (*activate_with_slope)(float* x, int64_t rows, int64_t blocks, float* slope);
  /// x ⊙= by, of one panel each.
  void (*multiply_each)(float* x, const float* by, int64_t rows, int64_t blocks);
  /// sum[c] += Σ_r x[r][c].
  void (*sum_columns)(const float* x, int64_t rows, int64_t blocks, float* sum);
  void (*layer_norm_gradient)(LayerNormGradient arguments);
  void (*attend_gradient)(AttendGradient arguments);
  void (*attention_gradient)(AttentionGradient arguments);
  /// DenseKernels::maximize(); winner[c] = place where x is larger.
  void (*maximize_at)(const float* x, int32_t place, int64_t count, float* out, int32_t* winner);
  void (*maximum_gradient)(MaximumGradient arguments);
};

/// Pairs of H hidden activations in bfloat16, rounded up to whole vectors.
inline int64_t hidden_pairs(int64_t H) { return (H + 31) / 32 * 16; }

/// Products of bfloat16 operands with sums in float32. Two inputs make a pair, the even one in the
/// lower half. Inputs are rounded to the nearest even; where the processor has no bfloat16
/// instructions the same is computed from float32 ones.
struct Bf16Kernels {
  /// `K` counts single inputs, of which (K + 1) / 2 pairs of weights are read. The partner of an
  /// odd last input must be zero in `weight`.
  void (*multiply)(MatrixProduct<float, uint32_t> product);
  /// The same of inputs in pairs, [rows, K] with rows kPanel / 2 apart; `K` counts pairs.
  void (*multiply_pairs)(MatrixProduct<uint32_t, uint32_t> product);
  /// out[r][c] (+)= Σ_k left[k][r] right[k][c] over `pairs` pairs, `rows` <= kPanel and `blocks`
  /// blocks of columns: the product of two matrices whose rows are what is summed over. All strides
  /// are kPanel.
  void (*multiply_transposed)(const uint32_t* left, int64_t rows, int64_t pairs,
                              const uint32_t* right, int64_t blocks, bool add, float* out);
  /// Two rows of `count` values as pairs, the even one in the lower half; without `odd`, zeros
  /// there.
  void (*pair_rows)(const float* even, const float* odd, int64_t count, uint32_t* out);
  /// DenseKernels::transpose() of pairs.
  void (*transpose)(TransposedRows<uint32_t> rows);
  /// GradientKernels::attention_gradient(), answered in pairs.
  void (*attention_gradient)(AttentionGradient panel, AttentionPairs out);
  /// As in DenseKernels, for what a product of bfloat16 reads next: GELU to 2 · 10^-4, a tenth of a
  /// rounding.
  void (*activate)(float* x, int64_t rows, int64_t blocks);
  /// GradientKernels::activate_with_slope(), the slope to 3 · 10^-4.
  void (*activate_with_slope)(float* x, int64_t rows, int64_t blocks, float* slope);
  void (*activate_sum)(const float* a, const float* b, int64_t count, float* out);
  /// DenseKernels::hidden_positions() with a row a pair: out [pairs, hidden_pairs(H)]; weight
  /// [F + 1, 2 hidden_pairs(H)], the bias last, zero past H.
  void (*hidden_positions)(PairGeometry geometry, const float* weight, int64_t H, uint32_t* out);
  /// SumKernels::projected_sums() with pairs of hidden activations and weights.
  void (*projected_sums)(NeighbourTable<float> near, ProjectedPositions<uint32_t, float> position,
                         float* out);
};

/// The points of a light prior.
struct PriorPoints {
  const float* position;  ///< [S, 3]
  const float* normal;    ///< [S, 6]
  const float* light;     ///< [S, 2 kPriorLight]
  const float* error;     ///< [S, 2], or null
};

/// Queries and the points near them.
struct PriorQueries {
  const float* position;  ///< [count, 3]
  const float* normal;    ///< [count, 3]
  const int64_t* index;   ///< [count, K], rows of the points
  int64_t count, K;       ///< 1 <= K <= kMaxPriorNeighbours
};

/// Weighted means over a query's neighbours.
struct PriorKernels {
  /// light_prior_means() (lte/ops/light_prior.h): out [count, columns].
  void (*means)(PriorPoints points, PriorQueries queries, PriorWeights weights, float* out);
  /// light_prior_features(): means and out [count, columns].
  void (*features)(const float* means, int64_t count, int64_t columns, PriorScales scales,
                   float* out);
};

/// Discs that a ray may meet in a cell: some columns of SurfelGrid::geometry, of which up to 16
/// past `count` may be read.
struct SurfelProbe {
  const float* geometry;  ///< a row is `stride` after the one before
  int64_t stride, count;  ///< count <= kMaxSurfels
  float origin[3], direction[3];
  float near, far;  ///< distances of the cell along the ray
  float limit;      ///< the largest distance that counts
};
inline constexpr int64_t kMaxSurfels = 64;

/// Where a ray meets the planes of discs: the distance along it, the square of that to the middle,
/// and the ray's share of the normal, which is negative on fronts. Only discs that are met have
/// them.
struct SurfelTests {
  float distance[kMaxSurfels], square[kMaxSurfels], toward[kMaxSurfels];
};

struct SurfelKernels {
  /// A bit for each disc that is met.
  uint64_t (*test)(SurfelProbe probe, SurfelTests* out);
};

/// The kernels of the best instruction set that the processor has: avx512 (for bfloat16: amx or
/// avx512_bf16), avx2 or baseline. The environment variable LTE_CPU_ISA names a lesser one, for
/// tests; it is read once.
const PointKernels& point_kernels();
const CurveKernels& curve_kernels();
const DenseKernels& dense_kernels();
const GradientKernels& gradient_kernels();
const Bf16Kernels& bf16_kernels();
const PriorKernels& prior_kernels();
const SurfelKernels& surfel_kernels();
template <typename T>
const SumKernels<T>& sum_kernels();
const char* cpu_isa();

}  // namespace lte::ops
