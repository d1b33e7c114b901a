#pragma once

#include <cstdint>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// rotate_heads() of float32 on the CPU, not differentiable; by the opposite angles if `back`.
at::Tensor rotate_heads_cpu(const at::Tensor& qkv, const at::Tensor& cosine, const at::Tensor& sine,
                            int64_t heads, bool back);

}  // namespace lte::ops
