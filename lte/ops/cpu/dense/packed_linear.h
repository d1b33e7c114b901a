// Weights of dense layers as the dense kernels read them, and such layers over tiles of rows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lte/base/unfilled_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

inline int64_t blocks_of(int64_t channels) { return (channels + kBlock - 1) / kBlock; }
inline int64_t panels_of(int64_t channels) { return (channels + kPanel - 1) / kPanel; }

/// y = x Wᵀ + b, packed so that a product reads one run of memory for each block of outputs.
struct PackedLinear {
  int64_t inputs = 0, outputs = 0, blocks = 0;
  std::vector<float> weight;    ///< [blocks, inputs, kBlock], zero past `outputs`
  std::vector<uint32_t> pairs;  ///< in bfloat16 instead: [blocks, ⌈inputs / 2⌉, kBlock] pairs
  std::vector<float> bias;      ///< [blocks * kBlock]

  PackedLinear() = default;
  /// @param w  [outputs, inputs] float32 or bfloat16 on the CPU, @param b [outputs] float32, or
  ///           undefined: zero
  PackedLinear(const at::Tensor& w, const at::Tensor& b);

  /// y = x W without bias.
  static PackedLinear transposed(const at::Tensor& w);

  bool in_bf16() const { return !pairs.empty(); }
  int64_t input_pairs() const { return (inputs + 1) / 2; }

  /// out (+)= W x over inputs [k, k + count), k even, for `count_blocks` blocks of outputs, and the
  /// bias if `with_bias`. `x` and `out` are one panel each.
  void multiply(const float* x, int64_t rows, int64_t k, int64_t count, int64_t first_block,
                int64_t count_blocks, bool with_bias, bool add, float* out) const;
};

/// Packs blocks [begin, end) of `w`, [outputs, inputs] bfloat16, contiguous, as PackedLinear holds
/// them.
void pack_pairs(const at::Tensor& w, int64_t begin, int64_t end, uint32_t* out);

/// std::copy_n() that makes whole blocks a few registers each: rows are too short for a call.
inline void copy_row(const float* from, int64_t columns, float* to) {
  int64_t c = 0;
  for (; c + kBlock <= columns; c += kBlock) std::copy_n(from + c, kBlock, to + c);
  if (c < columns) std::copy_n(from + c, columns - c, to + c);
}

/// Two rows of bfloat16 as pairs; without `odd`, zeros in its place.
inline void pair_halves(const at::BFloat16* even, const at::BFloat16* odd, int64_t count,
                        uint32_t* out) {
  if (odd == nullptr) {
    for (int64_t c = 0; c < count; ++c) out[c] = even[c].x;
    return;
  }
  const auto pair = [&](int64_t c) { out[c] = even[c].x | static_cast<uint32_t>(odd[c].x) << 16; };
  int64_t c = 0;
  for (; c + kBlock <= count; c += kBlock) {  // a loop of fixed length becomes a few registers
    for (int64_t lane = 0; lane < kBlock; ++lane) pair(c + lane);
  }
  for (; c < count; ++c) pair(c);
}

/// Rows of one panel of float32 as pairs of two rows, `to` [⌈rows / 2⌉, kPanel].
inline void pair_up_rows(const float* panel, int64_t rows, int64_t blocks, uint32_t* to) {
  for (int64_t r = 0; r < rows; r += 2) {
    const float* even = panel + r * kPanel;
    bf16_kernels().pair_rows(even, r + 1 < rows ? even + kPanel : nullptr, blocks * kBlock,
                             to + r / 2 * kPanel);
  }
}

/// A tile of `rows` rows at most, each as long as `channels`: panels of kPanel columns, one after
/// the other. Values are what they happen to be, but those that fill up the last block are finite:
/// kernels work on whole ones.
class Tile {
 public:
  Tile(int64_t rows, int64_t channels)
      : rows_(rows), values_(static_cast<size_t>(panels_of(channels) * rows * kPanel)) {
    if (channels % kBlock != 0) std::fill(values_.begin(), values_.end(), 0.0f);
  }

  float* panel(int64_t p) { return values_.data() + p * panel_stride(); }
  const float* panel(int64_t p) const { return values_.data() + p * panel_stride(); }
  int64_t panel_stride() const { return rows_ * kPanel; }

 private:
  int64_t rows_;
  UnfilledVector<float> values_;
};

/// Panel `p` of the outputs: to (+)= b + W x over all inputs. `to` is one panel, [rows, kPanel].
inline void dense_panel(const PackedLinear& layer, const Tile& x, int64_t rows, int64_t p, bool add,
                        float* to) {
  const int64_t first = p * (kPanel / kBlock);
  const int64_t blocks = std::min(layer.blocks - first, kPanel / kBlock);
  for (int64_t k = 0; k < layer.inputs; k += kPanel) {
    layer.multiply(x.panel(k / kPanel), rows, k, std::min(kPanel, layer.inputs - k), first, blocks,
                   k == 0, add || k > 0, to);
  }
}

/// out (+)= W x + b.
inline void dense(const PackedLinear& layer, const Tile& x, int64_t rows, bool add, Tile& out) {
  for (int64_t p = 0; p < panels_of(layer.outputs); ++p) {
    dense_panel(layer, x, rows, p, add, out.panel(p));
  }
}

/// out (+)= W2 GELU(W1 x + b1) + b2, by panels of the hidden layer: `hidden` is one panel.
void perceptron(const PackedLinear& first, const PackedLinear& second, const Tile& x, int64_t rows,
                bool add, Tile& hidden, Tile& out);

}  // namespace lte::ops
