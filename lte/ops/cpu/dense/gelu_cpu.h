// GELU and its gradient on the CPU, float32.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

at::Tensor gelu_cpu(const at::Tensor& x);
/// grad ⊙ GELU'(x).
at::Tensor gelu_gradient_cpu(const at::Tensor& x, const at::Tensor& grad);

}  // namespace lte::ops
