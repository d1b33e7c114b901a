// What the operators of norm_layers.h accept.
#pragma once

#include "lte/ops/arguments.h"
#include "lte/ops/linear_args.h"

namespace lte::ops {

/// x [n, C], gain and bias [C].
inline void check_norm_args(const at::Tensor& x, const at::Tensor& gain, const at::Tensor& bias,
                            const char* op) {
  TORCH_CHECK(x.dim() == 2 && x.scalar_type() == at::kFloat && x.is_cpu(), op,
              ": x must be [n, C] float32 on the CPU, got ", x.sizes(), " ", x.scalar_type(),
              " on ", x.device());
  for (const at::Tensor& t : {gain, bias}) check_shape(t, {x.size(1)}, at::kFloat, op, "a norm");
}

/// A dense layer after x's norm.
inline void check_layer_args(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias,
                             const char* op) {
  check_linear_args(x, weight, bias, op);
  for (const at::Tensor& t : {weight, bias}) {
    TORCH_CHECK(t.defined() && t.is_cpu(), op, ": weights must be on the CPU");
  }
  TORCH_CHECK(bias.scalar_type() == at::kFloat &&
                  (weight.scalar_type() == at::kFloat || weight.scalar_type() == at::kBFloat16),
              op, ": weights must be float32 or bfloat16 and biases float32, got ",
              weight.scalar_type(), " and ", bias.scalar_type());
}

}  // namespace lte::ops
