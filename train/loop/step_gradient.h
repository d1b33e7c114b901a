// The half of a step before the update, which training, the sweep of rates and learning by heart
// share: losses, gradients and their norm.
#pragma once

#include <cstdint>
#include <vector>

#include "train/data/example.h"
#include "train/loop/scene_gradients.h"
#include "train/optim/optimizer.h"

namespace lte::train {

struct StepGradient {
  double loss = 0;  ///< mean over all scenes of the step; of several processes this one's share
  double norm = 0;  ///< L2, before clipping
};

/// Leaves the gradient of the mean loss over `examples` in the model's parameters.
/// @param step  steps done before this one
/// @return its loss, which is finite, and its norm, which may not be
/// @throws lte::Error as SceneGradients::accumulate()
StepGradient step_gradient(const std::vector<Example>& examples, int64_t step,
                           SceneGradients* gradients, Optimizer* optimizer);

/// Goes through the examples of a step whose gradient is not finite and names the culprits.
/// @throws lte::Error naming step and scenes
[[noreturn]] void fail_on_gradient(const std::vector<Example>& examples, int64_t step,
                                   SceneGradients* gradients, Optimizer* optimizer);

}  // namespace lte::train
