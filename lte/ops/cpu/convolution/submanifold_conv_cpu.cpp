// Submanifold convolution on the CPU: gather, multiply, scatter, tap by tap.
//
// The forward pass gives every thread blocks of output rows and works a block through all taps
// while it is in the cache. float32 runs through the dense kernels, other types and odd widths
// through ATen's products. The blocks are the same for any number of threads, and every product
// runs on one thread, so results do not depend on it.
#include <algorithm>
#include <cstring>
#include <vector>

#include "lte/ops/cpu/convolution/convolution_tiles.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/cpu/kernels/tap_weights.h"
#include "lte/ops/submanifold_conv_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kRows = 512;  ///< output rows of a block
static_assert(kConvolutionBlock == kBlock);

/// Checked before.
ConvolutionPairs pairs_of(const at::Tensor& pairs, const at::Tensor& tap_begin) {
  const int64_t P = pairs.size(1);
  const auto* rows = pairs.const_data_ptr<int32_t>();
  return {rows, rows + P, tap_begin.const_data_ptr<int64_t>(), P, tap_begin.size(0) - 1};
}

template <typename T>
void gather(const T* from, int64_t C, const int32_t* rows, int64_t count, T* to) {
  for (int64_t i = 0; i < count; ++i) {
    std::memcpy(to + i * C, from + rows[i] * C, C * sizeof(T));
  }
}

template <typename T>
void add_row(const T* from, int64_t C, T* to) {
  for (int64_t c = 0; c < C; ++c) to[c] += from[c];
}

/// out[to] += in[from] W over the pairs whose output lies in [first, last).
template <typename T>
void convolve_rows(const at::Tensor& input, const at::Tensor& weight, const ConvolutionPairs& pairs,
                   int64_t first, int64_t last, at::Tensor& gathered, at::Tensor& product, T* out) {
  const int64_t Cin = input.size(1), Cout = weight.size(2);
  const auto* in = input.const_data_ptr<T>();
  for (int64_t tap = 0; tap < pairs.taps; ++tap) {
    const int32_t* tap_first = pairs.output + pairs.begin[tap];
    const int32_t* tap_last = pairs.output + pairs.begin[tap + 1];
    const int32_t* from = std::lower_bound(tap_first, tap_last, first);
    const int64_t count = std::lower_bound(from, tap_last, last) - from;
    if (count == 0) continue;
    const int32_t* rows = pairs.input + (from - pairs.output);
    at::Tensor to = product.narrow(0, 0, count);
    gather(in, Cin, rows, count, gathered.data_ptr<T>());
    at::mm_out(to, gathered.narrow(0, 0, count), weight.select(0, tap));
    const auto* value = product.const_data_ptr<T>();
    for (int64_t i = 0; i < count; ++i) add_row(value + i * Cout, Cout, out + from[i] * Cout);
  }
}

at::Tensor submanifold_conv_cpu(const at::Tensor& any_input, const at::Tensor& weight,
                                const std::optional<at::Tensor>& bias, const at::Tensor& pairs,
                                const at::Tensor& tap_begin) {
  check_submanifold_conv_args(any_input, weight, bias, pairs, tap_begin);
  const at::Tensor input = any_input.contiguous();
  const int64_t N = input.size(0), Cout = weight.size(2);
  const ConvolutionPairs p = pairs_of(pairs, tap_begin);
  at::Tensor out = at::empty({N, Cout}, input.options());
  if (bias.has_value() && bias->defined()) {
    out.copy_(*bias);
  } else {
    out.zero_();
  }
  if (input.scalar_type() == at::kFloat && suits_tiles(Cout)) {
    const at::Tensor w = weight.contiguous();
    const bool bf16 = w.scalar_type() == at::kBFloat16;
    const TapWeights weights =
        bf16 ? TapWeights(w.const_data_ptr<at::BFloat16>(), w.size(0), w.size(1), Cout)
             : TapWeights(w.const_data_ptr<float>(), w.size(1), Cout);
    convolve_tiles({input.const_data_ptr<float>(), N, input.size(1)}, weights, p,
                   out.data_ptr<float>());
    return out;
  }
  AT_DISPATCH_FLOATING_TYPES(input.scalar_type(), "submanifold_conv", [&] {
    auto* to = out.data_ptr<scalar_t>();
    const int64_t blocks = (N + kRows - 1) / kRows;
    at::parallel_for(0, blocks, 1, [&](int64_t begin, int64_t end) {
      const at::AutoDispatchBelowADInplaceOrView below;
      at::Tensor gathered = at::empty({kRows, input.size(1)}, input.options());
      at::Tensor product = at::empty({kRows, Cout}, input.options());
      for (int64_t block = begin; block < end; ++block) {
        const int64_t first = block * kRows, last = std::min(N, first + kRows);
        convolve_rows(input, weight, p, first, last, gathered, product, to);
      }
    });
  });
  return out;
}

/// Tap by tap: several outputs may read one input, so threads own ranges of input rows and each
/// scans all pairs.
template <typename T>
void input_gradient(const at::Tensor& grad, const at::Tensor& weight, const ConvolutionPairs& pairs,
                    at::Tensor& out) {
  const int64_t N = grad.size(0), Cin = weight.size(1), Cout = weight.size(2);
  const int64_t blocks = (N + kRows - 1) / kRows;
  const auto* g = grad.const_data_ptr<T>();
  auto* to = out.data_ptr<T>();
  at::parallel_for(0, blocks, 1, [&](int64_t begin, int64_t end) {
    const at::AutoDispatchBelowADInplaceOrView below;
    at::Tensor gathered = at::empty({kRows, Cout}, grad.options());
    at::Tensor product = at::empty({kRows, Cin}, grad.options());
    std::vector<int32_t> from, target;
    const auto flush = [&](int64_t tap) {
      const auto count = static_cast<int64_t>(from.size());
      if (count == 0) return;
      gather(g, Cout, from.data(), count, gathered.data_ptr<T>());
      at::Tensor result = product.narrow(0, 0, count);
      at::mm_out(result, gathered.narrow(0, 0, count), weight.select(0, tap).t());
      const auto* value = product.const_data_ptr<T>();
      for (int64_t i = 0; i < count; ++i) add_row(value + i * Cin, Cin, to + target[i] * Cin);
      from.clear();
      target.clear();
    };
    for (int64_t block = begin; block < end; ++block) {
      const int64_t first = block * kRows, last = std::min(N, first + kRows);
      for (int64_t tap = 0; tap < pairs.taps; ++tap) {
        for (int64_t i = pairs.begin[tap]; i < pairs.begin[tap + 1]; ++i) {
          if (pairs.input[i] < first || pairs.input[i] >= last) continue;
          from.push_back(pairs.output[i]);
          target.push_back(pairs.input[i]);
          if (static_cast<int64_t>(from.size()) == kRows) flush(tap);
        }
        flush(tap);
      }
    }
  });
}

/// Weights of a tap: gathered inputs, transposed, times gathered gradients. Threads own taps.
template <typename T>
void weight_gradient(const at::Tensor& grad, const at::Tensor& input, const ConvolutionPairs& pairs,
                     at::Tensor& out) {
  const int64_t Cin = input.size(1), Cout = grad.size(1);
  constexpr int64_t kDepth = 2048;  // pairs gathered at once
  at::parallel_for(0, pairs.taps, 1, [&](int64_t begin, int64_t end) {
    const at::AutoDispatchBelowADInplaceOrView below;
    at::Tensor inputs = at::empty({kDepth, Cin}, input.options());
    at::Tensor grads = at::empty({kDepth, Cout}, input.options());
    for (int64_t tap = begin; tap < end; ++tap) {
      at::Tensor to = out.select(0, tap);
      for (int64_t i = pairs.begin[tap]; i < pairs.begin[tap + 1]; i += kDepth) {
        const int64_t count = std::min(kDepth, pairs.begin[tap + 1] - i);
        gather(input.const_data_ptr<T>(), Cin, pairs.input + i, count, inputs.data_ptr<T>());
        gather(grad.const_data_ptr<T>(), Cout, pairs.output + i, count, grads.data_ptr<T>());
        at::addmm_out(to, to, inputs.narrow(0, 0, count).t(), grads.narrow(0, 0, count));
      }
    }
  });
}

std::tuple<at::Tensor, at::Tensor> submanifold_conv_backward_cpu(
    const at::Tensor& any_grad, const at::Tensor& any_input, const at::Tensor& weight,
    const at::Tensor& pairs, const at::Tensor& tap_begin, bool need_input, bool need_weight) {
  check_submanifold_conv_backward_args(any_grad, any_input, weight, pairs, tap_begin);
  const at::Tensor grad = any_grad.contiguous(), input = any_input.contiguous();
  const bool bf16 = input.scalar_type() == at::kBFloat16;
  const ConvolutionPairs p = pairs_of(pairs, tap_begin);
  at::Tensor by_input = at::zeros(need_input ? input.sizes() : at::IntArrayRef{0}, grad.options());
  at::Tensor by_weight =
      at::zeros(need_weight ? weight.sizes() : at::IntArrayRef{0}, grad.options());
  const int64_t Cin = weight.size(1), Cout = weight.size(2);
  if (bf16) {
    const ConvolutionRows g{grad.const_data_ptr<float>(), grad.size(0), Cout};
    const at::Tensor w = weight.contiguous();
    if (need_input) {
      input_gradient_tiles(g, w.const_data_ptr<at::BFloat16>(), Cin, p, by_input.data_ptr<float>());
    }
    if (need_weight) {
      weight_gradient_tiles(input.const_data_ptr<at::BFloat16>(), Cin, g, p,
                            by_weight.data_ptr<float>());
    }
    return {by_input, by_weight};
  }
  if (input.scalar_type() == at::kFloat && suits_tiles(Cin) && suits_tiles(Cout)) {
    const ConvolutionRows g{grad.const_data_ptr<float>(), grad.size(0), Cout};
    if (need_input) {
      const at::Tensor w = weight.contiguous();
      input_gradient_tiles(g, w.const_data_ptr<float>(), Cin, p, by_input.data_ptr<float>());
    }
    if (need_weight) {
      weight_gradient_tiles({input.const_data_ptr<float>(), input.size(0), Cin}, g, p,
                            by_weight.data_ptr<float>());
    }
    return {by_input, by_weight};
  }
  AT_DISPATCH_FLOATING_TYPES(input.scalar_type(), "submanifold_conv_backward", [&] {
    if (need_input) input_gradient<scalar_t>(grad, weight, p, by_input);
    if (need_weight) weight_gradient<scalar_t>(grad, input, p, by_weight);
  });
  return {by_input, by_weight};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("submanifold_conv", lte::ops::submanifold_conv_cpu);
  m.impl("submanifold_conv_backward", lte::ops::submanifold_conv_backward_cpu);
}
