// The paper's loss (equation 12): relative L2 in log space.
#pragma once

#include <ATen/core/Tensor.h>

namespace lte::nn {

struct LossConfig {
  double epsilon = 0.01;
  bool detach_denominator = false;  ///< the paper lets the gradient flow through the denominator
};

/// mean(w ((log(Î + 1) − log(I + 1)) / (log(Î + 1) + ε))²).
/// @param predicted  [Q, 3], non-negative, irradiance over the emission scalar; @param target the
/// same, reference
/// @param weight  w, [Q]; undefined: 1
/// @return scalar, differentiable in `predicted`
at::Tensor log_relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                             const LossConfig& config, const at::Tensor& weight = {});

}  // namespace lte::nn
