// A convolution's weights as the dense kernels read them, in float32 or bfloat16.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The weights of all taps, [taps, Cin, Cout]: float32 ones where they are, or bfloat16 ones in
/// pairs of inputs.
struct TapWeights {
  const float* single = nullptr;  ///< borrowed; null where `pairs` are
  std::vector<uint32_t> pairs;    ///< [taps, ⌈inputs / 2⌉, outputs]; empty where `single` is
  int64_t inputs, outputs;

  TapWeights(const float* weight, int64_t Cin, int64_t Cout)
      : single(weight), inputs(Cin), outputs(Cout) {}

  TapWeights(const at::BFloat16* weight, int64_t taps, int64_t Cin, int64_t Cout)
      : inputs(Cin), outputs(Cout) {
    const int64_t rows = (inputs + 1) / 2;
    pairs.resize(static_cast<size_t>(taps * rows * outputs));
    at::parallel_for(0, taps * rows, 64, [&](int64_t begin, int64_t end) {
      for (int64_t row = begin; row < end; ++row) {
        const int64_t input = row % rows * 2;
        const at::BFloat16* even = weight + (row / rows * inputs + input) * outputs;
        const bool odd = input + 1 < inputs;
        uint32_t* to = pairs.data() + row * outputs;
        for (int64_t c = 0; c < outputs; ++c) {
          to[c] = even[c].x | (odd ? static_cast<uint32_t>(even[outputs + c].x) << 16 : 0);
        }
      }
    });
  }

  TapWeights(std::vector<uint32_t> packed, int64_t Cin, int64_t Cout)
      : pairs(std::move(packed)), inputs(Cin), outputs(Cout) {}

  /// out (+)= x · the weights of inputs [k, k + count), k even, for `columns` outputs from
  /// `column`.
  void multiply(const float* x, int64_t rows, int64_t tap, int64_t k, int64_t count, int64_t column,
                int64_t columns, bool add, float* out) const {
    if (!pairs.empty()) {
      const int64_t row = tap * ((inputs + 1) / 2) + k / 2;
      bf16_kernels().multiply({x, rows, count, pairs.data() + row * outputs + column, outputs,
                               kBlock, nullptr, columns / kBlock, add, out});
    } else {
      const float* from = single + (tap * inputs + k) * outputs + column;
      dense_kernels().multiply(
          {x, rows, count, from, outputs, kBlock, nullptr, columns / kBlock, add, out});
    }
  }
};

}  // namespace lte::ops
