// The keys of `loss:` in the YAML configuration.
#pragma once

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

}  // namespace lte::nn
