// The paper's loss (equation 12), relative L2 in log space, and the same in linear space.
#pragma once

#include <ATen/core/Tensor.h>

#include "lte/base/enum_names.h"

namespace lte::nn {

/// f of relative_loss(): log(x + 1), as in the paper, or x. The mean of noisy references x is the
/// truth, and that of their logarithms is not. With `detach_denominator` the linear form is
/// least where the prediction is the mean (Müller et al. 2021, "Real-time Neural Radiance Caching",
/// section 3.2).
enum class LossSpace { Log, Linear };

constexpr EnumNames<LossSpace, 2> enum_names(LossSpace) {
  return {{{LossSpace::Log, "log"}, {LossSpace::Linear, "linear"}}};
}

struct LossConfig {
  double epsilon = 0.01;
  bool detach_denominator = false;  ///< the paper lets the gradient flow through the denominator
  LossSpace space = LossSpace::Log;
};

/// mean(((f(Î) − f(I)) / (f(Î) + ε))²).
///
/// @param predicted  [Q, 3], non-negative: irradiance over the emission scale
/// @param target     the same of the reference
/// @return scalar, differentiable in `predicted`
at::Tensor relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                         const LossConfig& config);

}  // namespace lte::nn
