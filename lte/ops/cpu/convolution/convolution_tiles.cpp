#include "lte/ops/cpu/convolution/convolution_tiles.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/cpu/dense/weight_gradient.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {
namespace {

/// One thread's working memory of a convolution.
class TileConvolution {
 public:
  TileConvolution(const ConvolutionRows& input, const TapWeights& weights,
                  const ConvolutionPairs& pairs, float* out)
      : in_(input.values),
        weights_(weights),
        Cin_(input.C),
        Cout_(weights.outputs),
        pairs_(pairs),
        out_(out),
        gathered_(kTileRows, Cin_),
        product_(kTileRows, kPanel) {}

  /// The output columns of one panel for rows [first, last).
  void run(int64_t first, int64_t last, int64_t panel) {
    for (int64_t tap = 0; tap < pairs_.taps; ++tap) {
      const int32_t* tap_last = pairs_.output + pairs_.begin[tap + 1];
      const int32_t* from = std::lower_bound(pairs_.output + pairs_.begin[tap], tap_last, first);
      const int32_t* to = std::lower_bound(from, tap_last, last);
      for (; from < to; from += kTileRows) {
        add_product(from, std::min<int64_t>(kTileRows, to - from), tap, panel);
      }
    }
  }

 private:
  void add_product(const int32_t* output, int64_t count, int64_t tap, int64_t panel) {
    const int32_t* rows = pairs_.input + (output - pairs_.output);
    const int64_t column = panel * kPanel, columns = std::min(kPanel, Cout_ - column);
    for (int64_t k = 0; k < Cin_; k += kPanel) {
      const int64_t inputs = std::min(kPanel, Cin_ - k);
      float* tile = gathered_.panel(k / kPanel);
      for (int64_t i = 0; i < count; ++i) {
        std::memcpy(tile + i * kPanel, in_ + rows[i] * Cin_ + k, inputs * sizeof(float));
      }
      weights_.multiply(tile, count, tap, k, inputs, column, columns, k > 0, product_.panel(0));
    }
    for (int64_t i = 0; i < count; ++i) {
      dense_kernels().accumulate(product_.panel(0) + i * kPanel, columns,
                                 out_ + output[i] * Cout_ + column);
    }
  }

  static constexpr int64_t kTileRows = 96;
  const float* in_;
  const TapWeights& weights_;
  int64_t Cin_, Cout_;
  const ConvolutionPairs& pairs_;
  float* out_;
  Tile gathered_, product_;
};

/// The pairs with input and output exchanged, those of a tap sorted by what was the input.
class ReversedPairs {
 public:
  /// @param rows  of the points
  ReversedPairs(const ConvolutionPairs& pairs, int64_t rows)
      : output_(pairs.count), input_(pairs.count), pairs_(pairs) {
    std::vector<int64_t> next(static_cast<size_t>(rows) + 1);
    for (int64_t tap = 0; tap < pairs.taps; ++tap) {
      const int64_t begin = pairs.begin[tap], end = pairs.begin[tap + 1];
      if (begin == end) continue;
      std::fill(next.begin(), next.end(), 0);  // then: where the pairs of each input begin
      for (int64_t i = begin; i < end; ++i) ++next[pairs.input[i] + 1];
      next[0] = begin;
      for (int64_t row = 0; row < rows; ++row) next[row + 1] += next[row];
      for (int64_t i = begin; i < end; ++i) {
        const int64_t to = next[pairs.input[i]]++;
        output_[to] = pairs.input[i];
        input_[to] = pairs.output[i];
      }
    }
  }

  ConvolutionPairs pairs() const {
    return {output_.data(), input_.data(), pairs_.begin, pairs_.count, pairs_.taps};
  }

 private:
  std::vector<int32_t> output_, input_;
  const ConvolutionPairs& pairs_;
};

void transpose(const TransposedRows<float>& rows) { dense_kernels().transpose(rows, 1); }
void transpose(const TransposedRows<uint32_t>& rows) { bf16_kernels().transpose(rows); }

/// [taps, rows, columns] -> [taps, columns, rows], whole blocks of rows, for the taps that have
/// pairs.
template <typename T>
std::vector<T> transposed_taps(const void* weight, int64_t rows, int64_t columns,
                               const ConvolutionPairs& pairs) {
  std::vector<T> out(static_cast<size_t>(pairs.taps * rows * columns));
  const auto* bytes = static_cast<const char*>(weight);
  at::parallel_for(0, pairs.taps, 1, [&](int64_t begin, int64_t end) {
    std::vector<T> block(static_cast<size_t>(kBlock * columns));
    for (int64_t tap = begin; tap < end; ++tap) {
      if (pairs.begin[tap] == pairs.begin[tap + 1]) continue;
      T* to = out.data() + tap * rows * columns;
      for (int64_t r = 0; r < rows; r += kBlock) {
        const size_t size = block.size() * sizeof(T);
        std::memcpy(block.data(), bytes + (tap * rows + r) * columns * sizeof(T), size);
        transpose({block.data(), columns, kBlock, columns, to + r, rows});
      }
    }
  });
  return out;
}

/// out[taps, left.C, right.C] += the sums over the pairs of each tap.
void add_weight_gradient(const GradientRows& left, const GradientRows& right,
                         const ConvolutionPairs& pairs, bool bf16, float* out) {
  const int64_t across = panels_of(right.C), tiles = panels_of(left.C) * across;
  at::parallel_for(0, pairs.taps * tiles, 1, [&](int64_t begin, int64_t end) {
    WeightGradient gradient(bf16);
    for (int64_t i = begin; i < end; ++i) {
      const int64_t tap = i / tiles, tile = i % tiles;
      gradient.add(left, tile / across, right, tile % across, pairs.begin[tap],
                   pairs.begin[tap + 1], out + tap * left.C * right.C);
    }
  });
}

}  // namespace

void convolve_tiles(const ConvolutionRows& input, const TapWeights& weights,
                    const ConvolutionPairs& pairs, float* out) {
  // Threads own blocks of rows and panels of columns: stages with few points have wide features.
  // The weights of a tap are read once a block, from the third-level cache. A row adds up its taps
  // in their order however many rows a block has.
  constexpr int64_t kMinRows = 256, kMaxRows = 2048;
  const int64_t share = (input.N + at::get_num_threads() - 1) / at::get_num_threads();
  const int64_t block = std::clamp(share, kMinRows, kMaxRows);
  const int64_t blocks = (input.N + block - 1) / block;
  at::parallel_for(0, blocks * panels_of(weights.outputs), 1, [&](int64_t begin, int64_t end) {
    TileConvolution convolution(input, weights, pairs, out);
    for (int64_t i = begin; i < end; ++i) {
      const int64_t first = i % blocks * block;
      convolution.run(first, std::min(input.N, first + block), i / blocks);
    }
  });
}

void input_gradient_tiles(const ConvolutionRows& grad, const float* weight, int64_t inputs,
                          const ConvolutionPairs& pairs, float* out) {
  const ReversedPairs reversed(pairs, grad.N);
  const auto transposed = transposed_taps<float>(weight, inputs, grad.C, pairs);
  convolve_tiles(grad, TapWeights(transposed.data(), grad.C, inputs), reversed.pairs(), out);
}

void input_gradient_tiles(const ConvolutionRows& grad, const at::BFloat16* weight, int64_t inputs,
                          const ConvolutionPairs& pairs, float* out) {
  const ReversedPairs reversed(pairs, grad.N);
  // Two bfloat16 that are neighbours in a row are a pair of the transposed matrix.
  TapWeights weights(transposed_taps<uint32_t>(weight, inputs, grad.C / 2, pairs), grad.C, inputs);
  convolve_tiles(grad, weights, reversed.pairs(), out);
}

void weight_gradient_tiles(const at::BFloat16* input, int64_t inputs, const ConvolutionRows& grad,
                           const ConvolutionPairs& pairs, float* out) {
  add_weight_gradient({nullptr, input, inputs, pairs.input},
                      {grad.values, nullptr, grad.C, pairs.output}, pairs, true, out);
}

void weight_gradient_tiles(const ConvolutionRows& input, const ConvolutionRows& grad,
                           const ConvolutionPairs& pairs, float* out) {
  add_weight_gradient({input.values, nullptr, input.C, pairs.input},
                      {grad.values, nullptr, grad.C, pairs.output}, pairs, false, out);
}

}  // namespace lte::ops
