// What dense layers and their gradients accept.
#pragma once

#include <optional>

#include "lte/ops/arguments.h"

namespace lte::ops {

/// x [..., C], weight [O, C], bias [O] or undefined, of any dtypes.
inline void check_linear_args(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias,
                              const char* op = "linear") {
  TORCH_CHECK(x.dim() >= 1 && weight.dim() == 2 && x.size(-1) == weight.size(1), op,
              ": x must be [..., C] and weight [O, C], got ", x.sizes(), " and ", weight.sizes());
  TORCH_CHECK(!bias.defined() || (bias.dim() == 1 && bias.size(0) == weight.size(0)), op,
              ": bias must be [", weight.size(0), "], got ", bias.sizes());
}

/// The same with a weight of float32 or bfloat16, all else float32, on one device.
inline void check_linear_rows_args(const at::Tensor& x, const at::Tensor& weight,
                                   const std::optional<at::Tensor>& bias) {
  const char* op = "linear_rows";
  const at::Tensor offset = bias.value_or(at::Tensor());
  check_linear_args(x, weight, offset, op);
  TORCH_CHECK(x.scalar_type() == at::kFloat &&
                  (weight.scalar_type() == at::kFloat || weight.scalar_type() == at::kBFloat16) &&
                  (!offset.defined() || offset.scalar_type() == at::kFloat),
              op, ": x and bias must be float32 and weight that or bfloat16, got ", x.scalar_type(),
              ", ", offset.defined() ? offset.scalar_type() : at::kFloat, " and ",
              weight.scalar_type());
  check_device(weight, "the weights", x, "rows of x", op);
  if (offset.defined()) check_device(offset, "the bias", x, "rows of x", op);
}

/// Both operands dense: rows are read as they lie.
inline void check_weight_gradient_args(const at::Tensor& grad, const at::Tensor& x) {
  const char* op = "weight_gradient";
  TORCH_CHECK(grad.dim() == 2 && grad.scalar_type() == at::kFloat && grad.is_contiguous(), op,
              ": grad must be [N, O] float32, contiguous, got ", grad.sizes(), " ",
              grad.scalar_type());
  TORCH_CHECK(x.dim() == 2 && x.size(0) == grad.size(0) &&
                  (x.scalar_type() == at::kFloat || x.scalar_type() == at::kBFloat16) &&
                  x.is_contiguous(),
              op, ": x must be [", grad.size(0), ", C] float32 or bfloat16, contiguous, got ",
              x.sizes(), " ", x.scalar_type());
  check_device(x, "rows of x", grad, "gradients", op);
}

}  // namespace lte::ops
