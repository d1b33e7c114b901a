// CUDA twins of convolution_pairs and submanifold_conv, composed of ATen's own kernels.
//
// Within one tap every output row occurs once, so index_add_ has no two writers to a row and the
// result is deterministic. Rows past the input fail the assertions of index_select().
#include <optional>
#include <tuple>

#include <ATen/ATen.h>
#include <torch/library.h>

#include "lte/ops/submanifold_conv_args.h"

namespace lte::ops {
namespace {

/// The pairs of a scene are made once before the network runs, so the host makes them.
std::tuple<at::Tensor, at::Tensor> convolution_pairs_cuda(const at::Tensor& cells, int64_t kernel) {
  check_convolution_pairs_args(cells, kernel);
  const auto [pairs, tap_begin] = convolution_pairs(cells.cpu(), kernel);
  return {pairs.to(cells.device()), tap_begin};
}

/// Rows of the pairs of one tap; undefined tensors if it has none.
struct Tap {
  at::Tensor output, input;
};

Tap tap_rows(const at::Tensor& pairs, const at::Tensor& tap_begin, int64_t tap) {
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  const int64_t count = begin[tap + 1] - begin[tap];
  if (count == 0) return {};
  return {pairs.select(0, 0).narrow(0, begin[tap], count),
          pairs.select(0, 1).narrow(0, begin[tap], count)};
}

/// a b. Where the factors are bfloat16, sums and result are float32.
at::Tensor product(const at::Tensor& a, const at::Tensor& b) {
  return a.scalar_type() == at::kBFloat16 ? at::mm(a, b, at::kFloat) : at::mm(a, b);
}

at::Tensor submanifold_conv_cuda(const at::Tensor& input, const at::Tensor& weight,
                                 const std::optional<at::Tensor>& bias, const at::Tensor& pairs,
                                 const at::Tensor& tap_begin) {
  check_submanifold_conv_args(input, weight, bias, pairs, tap_begin);
  at::Tensor out = at::zeros({input.size(0), weight.size(2)}, input.options());
  const at::Tensor read = input.to(weight.scalar_type());  // rounded, where the weight is
  for (int64_t tap = 0; tap < weight.size(0); ++tap) {
    const Tap rows = tap_rows(pairs, tap_begin, tap);
    if (!rows.output.defined()) continue;
    out.index_add_(0, rows.output,
                   product(read.index_select(0, rows.input), weight.select(0, tap)));
  }
  return bias.has_value() && bias->defined() ? out.add_(*bias) : out;
}

std::tuple<at::Tensor, at::Tensor> submanifold_conv_backward_cuda(
    const at::Tensor& grad, const at::Tensor& input, const at::Tensor& weight,
    const at::Tensor& pairs, const at::Tensor& tap_begin, bool need_input, bool need_weight) {
  check_submanifold_conv_backward_args(grad, input, weight, pairs, tap_begin);
  const auto zeros = [&](bool needed, const at::Tensor& like) {
    return at::zeros(needed ? like.sizes() : at::IntArrayRef{0}, grad.options());
  };
  at::Tensor grad_input = zeros(need_input, input), grad_weight = zeros(need_weight, weight);
  const at::Tensor read = grad.to(input.scalar_type());  // rounded, where the input was
  const int64_t centre = weight.size(0) / 2;
  for (int64_t tap = 0; tap < weight.size(0); ++tap) {
    const Tap rows = tap_rows(pairs, tap_begin, tap);
    if (!rows.output.defined()) continue;
    const at::Tensor outer = read.index_select(0, rows.output);
    if (need_weight) {
      grad_weight.select(0, tap).copy_(product(input.index_select(0, rows.input).t(), outer));
    }
    if (!need_input) continue;
    const at::Tensor inner = product(outer, weight.select(0, tap).t());
    if (tap == centre) {  // each point reads itself
      grad_input.index_add_(0, rows.input, inner);
    } else {
      // Points that share a cell read one representative, so a row may be named more than once:
      // sum in the order of the pairs first.
      const auto [sorted, order] = at::sort(rows.input, /*stable=*/true, 0, false);
      const auto [unique, inverse, counts] = at::unique_consecutive(sorted, true, true);
      const at::Tensor sums = at::segment_reduce(inner.index_select(0, order), "sum", counts);
      grad_input.index_add_(0, unique, sums);
    }
  }
  return {grad_input, grad_weight};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("convolution_pairs", convolution_pairs_cuda);
  m.impl("submanifold_conv", submanifold_conv_cuda);
  m.impl("submanifold_conv_backward", submanifold_conv_backward_cuda);
}

}  // namespace lte::ops
