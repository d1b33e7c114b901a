// GELU(x) = x Φ(x), Φ the normal distribution's, in the exact (erf) form.
#pragma once

#include <ATen/core/Tensor.h>

namespace lte::ops {

/// @param x  any shape, floating point
/// @return   its shape and dtype; differentiable once. float32 on the CPU by the kernels of
///           cpu/kernels.h, within 1e-6 of the largest |x|; others by ATen.
at::Tensor gelu(const at::Tensor& x);

}  // namespace lte::ops
