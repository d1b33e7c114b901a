// What gelu() accepts.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

inline void check_gelu_args(const at::Tensor& x) {
  TORCH_CHECK(at::isFloatingType(x.scalar_type()), "gelu: x must be floating point, got ",
              x.scalar_type());
}

}  // namespace lte::ops
