// The paper's loss (equation 12), relative L2 in log space, and the same in linear space.
#pragma once

#include "lte/nn/loss_config.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// mean(((f(Î) − f(I)) / (f(Î) + ε))²).
///
/// @param predicted  [Q, 3], non-negative: irradiance over the emission scale
/// @param target     the same of the reference
/// @return scalar, differentiable in `predicted`
at::Tensor relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                         const LossConfig& config);

}  // namespace lte::nn
