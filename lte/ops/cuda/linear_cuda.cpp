// On CUDA: dense layers and their gradients: cuBLAS multiplies, of bfloat16 operands with sums
// and results in float32.
#include <optional>
#include <vector>

#include <ATen/ops/gelu.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/mm.h>
#include <torch/library.h>

#include "lte/ops/linear_args.h"

namespace lte::ops {
namespace {

at::Tensor linear_rows_cuda(const at::Tensor& x, const at::Tensor& weight,
                            const std::optional<at::Tensor>& bias, bool gelu) {
  check_linear_rows_args(x, weight, bias);
  if (weight.scalar_type() == at::kFloat) {
    at::Tensor out = at::linear(x, weight, bias);
    return gelu ? at::gelu_(out) : out;
  }
  const at::Tensor rows = x.reshape({-1, weight.size(1)}).to(at::kBFloat16);
  at::Tensor out = at::mm(rows, weight.t(), at::kFloat);
  if (bias.has_value() && bias->defined()) out.add_(*bias);
  if (gelu) at::gelu_(out);
  std::vector<int64_t> sizes = x.sizes().vec();
  sizes.back() = weight.size(0);
  return out.view(sizes);
}

at::Tensor weight_gradient_cuda(const at::Tensor& grad, const at::Tensor& x) {
  check_weight_gradient_args(grad, x);
  if (x.scalar_type() == at::kFloat) return at::mm(grad.t(), x);
  return at::mm(grad.to(at::kBFloat16).t(), x, at::kFloat);
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("linear_rows", lte::ops::linear_rows_cuda);
  m.impl("weight_gradient", lte::ops::weight_gradient_cuda);
}
