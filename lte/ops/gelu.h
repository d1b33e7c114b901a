// GELU(x) = x Φ(x) in the exact (erf) form; Φ is the normal distribution's.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// @param x  any shape, floating point
/// @return   its shape and dtype; differentiable once
/// @throws c10::Error if `x` is not floating point
/// @note float32 on the CPU goes through cpu/kernels/kernels.h and is exact to 1e-6 of the largest
///       |x|. All else is ATen's.
at::Tensor gelu(const at::Tensor& x);

}  // namespace lte::ops
