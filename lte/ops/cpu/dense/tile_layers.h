// Norms, dense layers and perceptrons on tiles of rows, forwards and backwards.
#pragma once

#include <algorithm>
#include <vector>

#include "lte/ops/cpu/dense/linear_gradient.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/decoder_weights.h"
#include "lte/tensor/functions.h"

namespace lte::ops {

/// LayerNorm's gain and bias, zero past the last channel.
struct PackedNorm {
  std::vector<float> gain, bias;

  PackedNorm(const at::Tensor& g, const at::Tensor& b)
      : gain(static_cast<size_t>(blocks_of(g.size(0)) * kBlock)), bias(gain.size()) {
    const at::Tensor dense_gain = g.contiguous(), dense_bias = b.contiguous();
    std::copy_n(dense_gain.const_data_ptr<float>(), g.size(0), gain.begin());
    std::copy_n(dense_bias.const_data_ptr<float>(), g.size(0), bias.begin());
  }

  void apply(const Tile& x, int64_t rows, int64_t channels, Tile& out) const {
    dense_kernels().layer_norm(x.panel(0), rows, x.panel_stride(), channels, gain.data(),
                               bias.data(), out.panel(0));
  }
};

inline constexpr int64_t kNormTile = 96;      ///< rows at a time
inline constexpr int64_t kMinNormPart = 512;  ///< rows below which a second thread gains nothing

/// A dense layer, forwards and backwards.
struct Layer {
  PackedLinear forward, backward;

  explicit Layer(const LinearWeights& w)
      : forward(w.weight, w.bias), backward(PackedLinear::transposed(w.weight)) {}
};

/// What gradients by `weights` are written to: float32, whatever products read.
inline std::vector<at::Tensor> room_for(at::TensorList weights) {
  std::vector<at::Tensor> room;
  for (const at::Tensor& t : weights)
    room.push_back(at::empty(t.sizes(), t.options().dtype(at::kFloat)));
  return room;
}

struct Perceptron {
  Layer hidden, output;

  explicit Perceptron(const PerceptronWeights& w) : hidden(w.hidden), output(w.output) {}
};

struct NormSums {
  std::vector<float> gain, bias;

  explicit NormSums(const PackedNorm& norm) : gain(norm.gain.size()), bias(norm.gain.size()) {}
  /// As LinearGradient::write().
  void write(const NormWeights& to, bool add) const {
    put_row(gain.data(), to.gain.numel(), add, to.gain.data_ptr<float>());
    put_row(bias.data(), to.bias.numel(), add, to.bias.data_ptr<float>());
  }
};

/// by_x += the gradient through the norm of `x`, from that by its result.
inline void add_norm_gradient(const PackedNorm& norm, const Tile& x, const Tile& grad, int64_t rows,
                              int64_t channels, Tile& by_x, NormSums& sums) {
  gradient_kernels().layer_norm_gradient({x.panel(0), rows, x.panel_stride(), channels,
                                          norm.gain.data(), grad.panel(0), by_x.panel(0),
                                          sums.gain.data(), sums.bias.data()});
}

struct PerceptronSums {
  LinearGradient hidden, output;

  explicit PerceptronSums(const Perceptron& p)
      : hidden(p.hidden.forward), output(p.output.forward) {}
  void write(const PerceptronWeights& to, bool add) const {
    hidden.write(to.hidden.weight, to.hidden.bias, add);
    output.write(to.output.weight, to.output.bias, add);
  }
};

/// A perceptron's hidden layer of a tile: GELU's values, and its slopes.
struct Hidden {
  Tile value, slope;

  Hidden(int64_t rows, int64_t width) : value(rows, width), slope(rows, width) {}
};

/// value = GELU(W x + b) of the hidden layer, with the accuracy that the output layer reads.
inline void activate(const Perceptron& net, const Tile& x, int64_t rows, Hidden& to) {
  dense(net.hidden.forward, x, rows, false, to.value);
  const int64_t width = net.hidden.forward.outputs;
  const auto activate_with_slope = net.output.forward.in_bf16()
                                       ? bf16_kernels().activate_with_slope
                                       : gradient_kernels().activate_with_slope;
  for (int64_t p = 0; p < panels_of(width); ++p) {
    activate_with_slope(to.value.panel(p), rows, blocks_of(std::min(kPanel, width - p * kPanel)),
                        to.slope.panel(p));
  }
}

/// From the gradient by the hidden layer's values in `grad` to that before GELU.
inline void deactivate(const Hidden& hidden, int64_t width, int64_t rows, Tile& grad) {
  for (int64_t p = 0; p < panels_of(width); ++p) {
    gradient_kernels().multiply_each(grad.panel(p), hidden.slope.panel(p), rows,
                                     blocks_of(std::min(kPanel, width - p * kPanel)));
  }
}

/// A perceptron backwards: from the gradient by its output to that by its input, which is not
/// wanted if `by_input` is null.
inline void return_through(const Perceptron& net, const Tile& grad, const Tile& input,
                           const Hidden& hidden, int64_t rows, bool add, PerceptronSums& sums,
                           Tile& by_hidden, Tile* by_input) {
  sums.output.add(grad, hidden.value, rows);
  dense(net.output.backward, grad, rows, false, by_hidden);
  deactivate(hidden, net.hidden.forward.outputs, rows, by_hidden);
  sums.hidden.add(by_hidden, input, rows);
  if (by_input != nullptr) dense(net.hidden.backward, by_hidden, rows, add, *by_input);
}

inline void clear_rows(Tile& tile, int64_t columns, int64_t rows) {
  for (int64_t p = 0; p < panels_of(columns); ++p) std::fill_n(tile.panel(p), rows * kPanel, 0.0f);
}

/// Adds `row`, of the tile's columns to whole blocks, to each of its rows.
inline void add_to_rows(const std::vector<float>& row, int64_t rows, Tile& tile) {
  const auto width = static_cast<int64_t>(row.size());
  for (int64_t c = 0; c < width; c += kPanel) {
    for (int64_t r = 0; r < rows; ++r) {
      dense_kernels().accumulate(row.data() + c, std::min(kPanel, width - c),
                                 tile.panel(c / kPanel) + r * kPanel);
    }
  }
}

/// Rows [first, first + rows) of a matrix [., columns] as a tile, and back.
inline void load_rows(const float* from, int64_t columns, int64_t first, int64_t rows, Tile& to) {
  for (int64_t c = 0; c < columns; c += kPanel) {
    for (int64_t r = 0; r < rows; ++r) {
      copy_row(from + (first + r) * columns + c, std::min(kPanel, columns - c),
               to.panel(c / kPanel) + r * kPanel);
    }
  }
}
inline void store_rows(const Tile& from, int64_t columns, int64_t first, int64_t rows, float* to) {
  for (int64_t c = 0; c < columns; c += kPanel) {
    for (int64_t r = 0; r < rows; ++r) {
      copy_row(from.panel(c / kPanel) + r * kPanel, std::min(kPanel, columns - c),
               to + (first + r) * columns + c);
    }
  }
}

}  // namespace lte::ops
