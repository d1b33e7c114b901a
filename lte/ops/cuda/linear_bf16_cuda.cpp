// CUDA twins of the products of bfloat16 operands: cuBLAS's, with sums and results in float32.
#include <optional>
#include <vector>

#include <ATen/ops/gelu.h>
#include <ATen/ops/mm.h>
#include <c10/util/Exception.h>
#include <torch/library.h>

namespace lte::ops {
namespace {

at::Tensor linear_bf16_cuda(const at::Tensor& x, const at::Tensor& weight,
                            const std::optional<at::Tensor>& bias, bool gelu) {
  TORCH_CHECK(weight.dim() == 2 && weight.scalar_type() == at::kBFloat16,
              "linear_bf16: weight must be [O, C] bfloat16, got ", weight.sizes(), " ",
              weight.scalar_type());
  TORCH_CHECK(x.dim() >= 1 && x.size(-1) == weight.size(1) && x.scalar_type() == at::kFloat,
              "linear_bf16: x must be [..., ", weight.size(1), "] float32, got ", x.sizes(), " ",
              x.scalar_type());
  const at::Tensor rows = x.reshape({-1, weight.size(1)}).to(at::kBFloat16);
  at::Tensor out = at::mm(rows, weight.t(), at::kFloat);
  if (bias.has_value() && bias->defined()) out.add_(*bias);
  if (gelu) at::gelu_(out);
  std::vector<int64_t> sizes = x.sizes().vec();
  sizes.back() = weight.size(0);
  return out.view(sizes);
}

at::Tensor weight_gradient_bf16_cuda(const at::Tensor& grad, const at::Tensor& x) {
  return at::mm(grad.to(at::kBFloat16).t(), x, at::kFloat);
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("linear_bf16", lte::ops::linear_bf16_cuda);
  m.impl("weight_gradient_bf16", lte::ops::weight_gradient_bf16_cuda);
}
