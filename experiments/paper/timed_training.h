// Training for an amount of processor time, so that methods of different cost are given the same.
#pragma once

#include <cstdint>
#include <functional>

#include <ATen/core/Tensor.h>
#include <torch/optim/optimizer.h>

namespace lte::experiments {

struct TimedTraining {
  double seconds = 60;  ///< processor time of steps alone
  double rate = 1e-3;   ///< learning rate at first; a cosine brings it to a hundredth
};

/// Steps until the time is used.
/// @param loss   the loss of a step, to be differentiated
/// @param after  called after each step with its number, from 1, and the seconds used; its own time
///               does not count
/// @return       steps
/// @throws lte::Error naming the step whose loss is not finite
int64_t train_for(const TimedTraining& training, torch::optim::Optimizer& optimizer,
                  const std::function<at::Tensor()>& loss,
                  const std::function<void(int64_t step, double used)>& after = {});

}  // namespace lte::experiments
