// On CUDA: submanifold_conv and its gradients: the products of all pairs, of all taps in one
// launch, and one kernel that adds up what falls on a row. Factors in bfloat16 are multiplied as
// float32. In float64, and of very large kernels, rows are gathered, and each tap is a matrix
// product of LibTorch's.
//
// The kernel that adds has a thread for each row and channel, which takes the pairs of its row in
// their order: no atomics, and the sums have the same bits each time.
#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include <ATen/ATen.h>
#include <ATen/Dispatch.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/cuda/tap_products.h"
#include "lte/ops/submanifold_conv_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 256;
/// Numbers of the pairs' rows that exist at a time, of one tap at least: 256 MB in float32.
constexpr int64_t kPairNumbers = int64_t{1} << 26;

/// Taps whose pairs are taken together.
struct TapRun {
  int64_t first_tap, last_tap;  ///< [first_tap, last_tap)
  int64_t begin, pairs;         ///< its pairs are [begin, begin + pairs)
};

std::vector<TapRun> runs_of_taps(const at::Tensor& tap_begin, int64_t channels) {
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  const int64_t taps = tap_begin.size(0) - 1, most = kPairNumbers / std::max<int64_t>(channels, 1);
  std::vector<TapRun> runs;
  for (int64_t tap = 0; tap < taps;) {
    const int64_t first = tap++;
    while (tap < taps && begin[tap + 1] - begin[first] <= most) ++tap;
    const int64_t pairs = begin[tap] - begin[first];
    if (pairs > 0) runs.push_back({first, tap, begin[first], pairs});
  }
  return runs;
}

/// Calls function(tap, first of its pairs within the run, their number) for taps that have any.
template <typename Function>
void for_each_tap(const TapRun& run, const at::Tensor& tap_begin, const Function& function) {
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  for (int64_t tap = run.first_tap; tap < run.last_tap; ++tap) {
    const int64_t pairs = begin[tap + 1] - begin[tap];
    if (pairs > 0) function(tap, begin[tap] - run.begin, pairs);
  }
}

/// Whether the products are tap_products.h's.
bool in_one_launch(const at::Tensor& rows, const at::Tensor& weight) {
  return rows.scalar_type() == at::kFloat && weight.scalar_type() == at::kFloat &&
         weight.size(0) <= kMaxTaps;
}

/// A factor as the kernels read it: in float32 with the values of bfloat16 where the weights are
/// that. A product a tap in bfloat16 would be some thirty launches, which take longer.
at::Tensor factor(const at::Tensor& values, at::ScalarType weights) {
  return weights == at::kBFloat16 ? values.to(weights).to(at::kFloat) : values;
}

/// `order` lists the rows of `values` by the row of `out` that they go to; those of row r are
/// [begin[r], begin[r + 1]).
template <typename T>
__global__ void add_rows_kernel(const T* values, const int64_t* order, const int64_t* begin, T* out,
                                int64_t rows, int64_t C) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (i >= rows * C) return;
  const int64_t row = i / C, c = i % C;
  T sum = out[i];
  for (int64_t s = begin[row]; s < begin[row + 1]; ++s) sum += values[order[s] * C + c];
  out[i] = sum;
}

/// out[to[p]] += values[p], in the order of p.
void add_rows(const at::Tensor& values, const at::Tensor& to, at::Tensor* out) {
  const int64_t rows = out->size(0), C = out->size(1);
  if (rows * C == 0) return;
  const auto [sorted, order] = at::sort(to, /*stable=*/true, /*dim=*/0, /*descending=*/false);
  const at::Tensor begin = at::searchsorted(sorted, at::arange(rows + 1, to.options()));
  const auto blocks = static_cast<unsigned>((rows * C + kThreads - 1) / kThreads);
  AT_DISPATCH_FLOATING_TYPES(values.scalar_type(), "submanifold_conv", [&] {
    add_rows_kernel<scalar_t><<<blocks, kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
        values.const_data_ptr<scalar_t>(), order.const_data_ptr<int64_t>(),
        begin.const_data_ptr<int64_t>(), out->data_ptr<scalar_t>(), rows, C);
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  });
}

at::Tensor submanifold_conv_cuda(const at::Tensor& given_input, const at::Tensor& given_weight,
                                 const std::optional<at::Tensor>& bias, const at::Tensor& pairs,
                                 const at::Tensor& tap_begin) {
  check_submanifold_conv_args(given_input, given_weight, bias, pairs, tap_begin);
  const at::ScalarType type = given_weight.scalar_type();
  const at::Tensor input = factor(given_input, type), weight = factor(given_weight, type);
  const c10::cuda::CUDAGuard guard(input.device());
  const int64_t N = input.size(0), inputs = weight.size(1), outputs = weight.size(2);
  at::Tensor out = bias.has_value() && bias->defined()
                       ? bias->unsqueeze(0).expand({N, outputs}).contiguous()
                       : at::zeros({N, outputs}, input.options());
  if (in_one_launch(input, weight)) {
    const at::Tensor products = products_by_tap(input.contiguous(), pairs[1], weight.contiguous(),
                                                tap_begin, /*transposed=*/false);
    add_rows(products, pairs[0], &out);
    return out;
  }
  for (const TapRun& run : runs_of_taps(tap_begin, std::max(inputs, outputs))) {
    const at::Tensor rows = pairs.narrow(1, run.begin, run.pairs);
    const at::Tensor gathered = input.index_select(0, rows.select(0, 1));
    const at::Tensor products = at::empty({run.pairs, outputs}, out.options());
    for_each_tap(run, tap_begin, [&](int64_t tap, int64_t first, int64_t count) {
      at::Tensor of_tap = products.narrow(0, first, count);
      at::mm_out(of_tap, gathered.narrow(0, first, count), weight.select(0, tap));
    });
    add_rows(products, rows.select(0, 0), &out);
  }
  return out;
}

std::tuple<at::Tensor, at::Tensor> submanifold_conv_backward_cuda(
    const at::Tensor& given_grad, const at::Tensor& given_input, const at::Tensor& given_weight,
    const at::Tensor& pairs, const at::Tensor& tap_begin, bool need_input, bool need_weight) {
  check_submanifold_conv_backward_args(given_grad, given_input, given_weight, pairs, tap_begin);
  const at::ScalarType type = given_weight.scalar_type();
  const at::Tensor grad = factor(given_grad, type), input = factor(given_input, type),
                   weight = factor(given_weight, type);
  const c10::cuda::CUDAGuard guard(grad.device());
  const auto zeros = [&](bool needed, const at::Tensor& like) {
    return at::zeros(needed ? like.sizes() : at::IntArrayRef{0}, grad.options());
  };
  at::Tensor grad_input = zeros(need_input, input), grad_weight = zeros(need_weight, weight);
  if (in_one_launch(input, weight)) {
    const at::Tensor right = grad.contiguous(), left = input.contiguous();
    if (need_weight)
      grad_weight = outer_products_by_tap(left, pairs[1], right, pairs[0], tap_begin);
    if (need_input)
      add_rows(products_by_tap(right, pairs[0], weight.contiguous(), tap_begin,
                               /*transposed=*/true),
               pairs[1], &grad_input);
    return {grad_input, grad_weight};
  }
  const int64_t inputs = weight.size(1), outputs = weight.size(2);
  for (const TapRun& run : runs_of_taps(tap_begin, std::max(inputs, outputs))) {
    const at::Tensor rows = pairs.narrow(1, run.begin, run.pairs);
    const at::Tensor outer = grad.index_select(0, rows.select(0, 0));
    if (need_weight) {
      const at::Tensor gathered = input.index_select(0, rows.select(0, 1));
      for_each_tap(run, tap_begin, [&](int64_t tap, int64_t first, int64_t count) {
        at::Tensor of_tap = grad_weight.select(0, tap);
        at::mm_out(of_tap, gathered.narrow(0, first, count).t(), outer.narrow(0, first, count));
      });
    }
    if (!need_input) continue;
    const at::Tensor products = at::empty({run.pairs, inputs}, grad.options());
    for_each_tap(run, tap_begin, [&](int64_t tap, int64_t first, int64_t count) {
      at::Tensor of_tap = products.narrow(0, first, count);
      at::mm_out(of_tap, outer.narrow(0, first, count), weight.select(0, tap).t());
    });
    add_rows(products, rows.select(0, 1), &grad_input);
  }
  return {grad_input, grad_weight};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("submanifold_conv", submanifold_conv_cuda);
  m.impl("submanifold_conv_backward", submanifold_conv_backward_cuda);
}

}  // namespace lte::ops
