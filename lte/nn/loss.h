// The paper's loss (equation 12), relative L2 in log space, and the same in linear space.
#pragma once

#include <ATen/core/Tensor.h>

namespace lte::nn {

struct LossConfig {
  double epsilon = 0.01;
  bool detach_denominator = false;  ///< the paper lets the gradient flow through the denominator
  /// f below is log(x + 1), as in the paper, or x. Of noisy references the mean of x is the truth,
  /// that of its logarithm is not: with `detach_denominator` the linear form is least where the
  /// prediction is the mean (Müller et al. 2021, "Real-time Neural Radiance Caching", section 3.2).
  bool logarithmic = true;
};

/// mean(w ((f(Î) − f(I)) / (f(Î) + ε))²).
/// @param predicted  [Q, 3], non-negative, irradiance over the emission scalar; @param target the
/// same, reference
/// @param weight  w, [Q]; undefined: 1
/// @return scalar, differentiable in `predicted`
at::Tensor relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                         const LossConfig& config, const at::Tensor& weight = {});

}  // namespace lte::nn
