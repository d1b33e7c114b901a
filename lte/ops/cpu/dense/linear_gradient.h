// Gradients of dense layers by their weights, summed up over tiles of rows.
#pragma once

#include <algorithm>
#include <vector>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// to = from, or to += from.
inline void put_row(const float* from, int64_t count, bool add, float* to) {
  if (add) {
    dense_kernels().accumulate(from, count, to);
  } else {
    copy_row(from, count, to);
  }
}

/// What a thread has summed up of the gradients of y = x Wᵀ + b by W and b. Of a layer in bfloat16
/// products read gradients and inputs rounded.
class LinearGradient {
 public:
  explicit LinearGradient(const PackedLinear& layer)
      : inputs_(layer.inputs),
        outputs_(layer.outputs),
        in_bf16_(layer.in_bf16()),
        weight_(static_cast<size_t>(panels_of(inputs_) * outputs_ * kPanel)),
        bias_(static_cast<size_t>(blocks_of(outputs_) * kBlock)) {}

  /// @param grad  by y, [rows, outputs], @param x [rows, inputs], finite to whole blocks
  void add(const Tile& grad, const Tile& x, int64_t rows) {
    for (int64_t p = 0; p < panels_of(inputs_); ++p) add_panel(grad, x.panel(p), p, rows);
  }

  /// The same with panel `p` of x alone; the bias goes with the first.
  void add_panel(const Tile& grad, const float* x, int64_t p, int64_t rows) {
    const int64_t blocks = std::min(blocks_of(inputs_) - p * kPanelBlocks, kPanelBlocks);
    if (in_bf16_) pair_up(x, rows, blocks, x_pairs_);
    for (int64_t o = 0; o < outputs_; o += kPanel) {
      const float* g = grad.panel(o / kPanel);
      const int64_t count = std::min(kPanel, outputs_ - o);
      float* to = weight_.data() + (p * outputs_ + o) * kPanel;
      if (in_bf16_) {
        pair_up(g, rows, blocks_of(count), grad_pairs_);
        bf16_kernels().multiply_transposed(grad_pairs_.data(), count, (rows + 1) / 2,
                                           x_pairs_.data(), blocks, true, to);
      } else {
        gradient_kernels().multiply_transposed(
            {g, count, rows, x, kPanel, kBlock, nullptr, blocks, true, to});
      }
      if (p == 0) gradient_kernels().sum_columns(g, rows, blocks_of(count), bias_.data() + o);
    }
  }

  /// Writes the sums to tensors of the shapes of W and b, or adds them to what these hold.
  void write(const at::Tensor& weight, const at::Tensor& bias, bool add) const {
    put_row(bias_.data(), outputs_, add, bias.data_ptr<float>());
    auto* w = weight.data_ptr<float>();
    for (int64_t o = 0; o < outputs_; ++o) {
      for (int64_t i = 0; i < inputs_; i += kPanel) {
        put_row(weight_.data() + (i / kPanel * outputs_ + o) * kPanel,
                std::min(kPanel, inputs_ - i), add, w + o * inputs_ + i);
      }
    }
  }

 private:
  /// Rows of a panel as pairs of two rows.
  static void pair_up(const float* panel, int64_t rows, int64_t blocks, std::vector<uint32_t>& to) {
    to.resize(static_cast<size_t>((rows + 1) / 2 * kPanel));
    pair_up_rows(panel, rows, blocks, to.data());
  }

  static constexpr int64_t kPanelBlocks = kPanel / kBlock;
  int64_t inputs_, outputs_;
  bool in_bf16_;
  std::vector<float> weight_;  ///< [panels of inputs, outputs, kPanel]
  std::vector<float> bias_;
  std::vector<uint32_t> grad_pairs_, x_pairs_;  ///< of a tile, in bfloat16
};

/// Runs of `count` rows that are worked off by themselves, so that sums over rows are the same for
/// any number of threads: kMaxParts at most, of at least `least` rows.
struct RowParts {
  static constexpr int64_t kMaxParts = 4;
  int64_t count, parts;

  RowParts(int64_t rows, int64_t least)
      : count(rows), parts(std::clamp<int64_t>(rows / least, 1, kMaxParts)) {}
  int64_t begin(int64_t part) const { return count * part / parts; }
};

}  // namespace lte::ops
