// Submanifold convolution on the CPU: gather, multiply, scatter, tap by tap.
//
// The forward pass gives every thread blocks of output rows and works a block through all taps
// while it is in the cache. float32 runs through the dense kernels, other types and odd widths
// through ATen's products. The blocks are the same for any number of threads, and every product
// runs on one thread, so results do not depend on it.
#include <algorithm>
#include <cstring>
#include <vector>

#include <ATen/Dispatch.h>
#include <ATen/Parallel.h>
#include <ATen/core/LegacyTypeDispatch.h>
#include <ATen/ops/addmm.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/mm.h>
#include <ATen/ops/zeros.h>
#include <ATen/ops/zeros_like.h>
#include <torch/library.h>

#include "lte/ops/arguments.h"
#include "lte/ops/cpu/convolution_tiles.h"
#include "lte/ops/cpu/kernels/tap_weights.h"
#include "lte/ops/cpu/packed_linear.h"
#include "lte/ops/submanifold_conv.h"

namespace lte::ops {
namespace {

constexpr int64_t kRows = 512;  ///< output rows of a block

ConvolutionPairs check_pairs(const at::Tensor& pairs, const at::Tensor& tap_begin, int64_t taps,
                             int64_t N) {
  const char* op = "submanifold_conv";
  TORCH_CHECK(pairs.dim() == 2 && pairs.size(0) == 2 && pairs.scalar_type() == at::kInt &&
                  pairs.is_contiguous(),
              op, ": pairs must be [2, P] int32, contiguous, got ", pairs.sizes(), " ",
              pairs.scalar_type());
  TORCH_CHECK(tap_begin.dim() == 1 && tap_begin.size(0) == taps + 1 &&
                  tap_begin.scalar_type() == at::kLong && tap_begin.is_contiguous(),
              op, ": tap_begin must be [taps + 1] int64 with the weight's ", taps, " taps, got ",
              tap_begin.sizes(), " ", tap_begin.scalar_type());
  const int64_t P = pairs.size(1);
  const auto* rows = pairs.const_data_ptr<int32_t>();
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  TORCH_CHECK(begin[0] == 0 && begin[taps] == P && std::is_sorted(begin, begin + taps + 1), op,
              ": tap_begin does not divide the ", P, " pairs");
  const int64_t bad = first_row(2 * P, [&](int64_t i) { return rows[i] < 0 || rows[i] >= N; });
  TORCH_CHECK(bad == 2 * P, op, ": pair ", bad % std::max<int64_t>(P, 1), " names row ", rows[bad],
              " of an input of ", N, " rows");
  for (int64_t tap = 0; tap < taps; ++tap) {
    TORCH_CHECK(std::is_sorted(rows + begin[tap], rows + begin[tap + 1]), op, ": pairs of tap ",
                tap, " are not sorted by output");
  }
  return {rows, rows + P, begin, P, taps};
}

void check_conv_args(const at::Tensor& input, const at::Tensor& weight, bool allow_bf16) {
  const char* op = "submanifold_conv";
  TORCH_CHECK(input.dim() == 2, op, ": input must be [N, Cin], got ", input.sizes());
  TORCH_CHECK(weight.dim() == 3 && weight.size(1) == input.size(1), op,
              ": weight must be [taps, Cin, Cout] with Cin = ", input.size(1), ", got ",
              weight.sizes());
  if (allow_bf16 && input.scalar_type() == at::kFloat && weight.scalar_type() == at::kBFloat16) {
    static_assert(kConvolutionBlock == kBlock);
    TORCH_CHECK(weight.size(2) % kBlock == 0, op, ": bfloat16 weights need a multiple of ", kBlock,
                " output channels, got ", weight.size(2));
    return;
  }
  TORCH_CHECK((input.scalar_type() == at::kFloat || input.scalar_type() == at::kDouble) &&
                  weight.scalar_type() == input.scalar_type(),
              op, ": input and weight must both be float32 or float64, got ", input.scalar_type(),
              " and ", weight.scalar_type());
}

/// Of a backward pass in bfloat16.
void check_rounded_args(const at::Tensor& input, const at::Tensor& weight) {
  TORCH_CHECK(input.dim() == 2 && weight.dim() == 3 && weight.size(1) == input.size(1) &&
                  weight.scalar_type() == at::kBFloat16 && weight.size(1) % kBlock == 0 &&
                  weight.size(2) % kBlock == 0,
              "submanifold_conv_backward: a bfloat16 input [N, Cin] needs a bfloat16 weight "
              "[taps, Cin, Cout] with multiples of ",
              kBlock, " channels, got ", input.sizes(), " and ", weight.sizes(), " ",
              weight.scalar_type());
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
  check_conv_args(any_input, weight, true);
  const at::Tensor input = any_input.contiguous();
  const int64_t N = input.size(0), Cout = weight.size(2);
  const ConvolutionPairs p = check_pairs(pairs, tap_begin, weight.size(0), N);
  const bool has_bias = bias.has_value() && bias->defined();
  TORCH_CHECK(!has_bias || (bias->dim() == 1 && bias->size(0) == Cout &&
                            bias->scalar_type() == input.scalar_type() && bias->is_contiguous()),
              "submanifold_conv: bias must be [", Cout, "] of the input's dtype");
  at::Tensor out = at::empty({N, Cout}, input.options());
  if (has_bias) {
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
  const at::Tensor grad = any_grad.contiguous(), input = any_input.contiguous();
  const bool bf16 = input.scalar_type() == at::kBFloat16;
  if (bf16) {
    check_rounded_args(input, weight);
  } else {
    check_conv_args(input, weight, false);
  }
  TORCH_CHECK(grad.dim() == 2 && grad.size(0) == input.size(0) && grad.size(1) == weight.size(2) &&
                  grad.scalar_type() == (bf16 ? at::kFloat : input.scalar_type()),
              "submanifold_conv_backward: grad must be [", input.size(0), ", ", weight.size(2),
              "] of the input's dtype, or float32 where that is bfloat16, got ", grad.sizes(), " ",
              grad.scalar_type());
  const ConvolutionPairs p = check_pairs(pairs, tap_begin, weight.size(0), input.size(0));
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
