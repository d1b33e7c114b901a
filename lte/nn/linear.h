// torch::nn::Linear on lte::ops::linear: the same parameters, names and first values.
#pragma once

#include <torch/nn/modules/linear.h>

#include "lte/ops/linear.h"

namespace lte::nn {

/// Parameters: `weight` [out, in], `bias` [out] (checkpoint names; do not rename).
class LinearImpl : public torch::nn::LinearImpl {
 public:
  using torch::nn::LinearImpl::LinearImpl;

  /// @param x  [..., in]
  /// @return   [..., out]
  at::Tensor forward(const at::Tensor& x) { return ops::linear(x, weight, bias); }
};
TORCH_MODULE(Linear);

}  // namespace lte::nn
