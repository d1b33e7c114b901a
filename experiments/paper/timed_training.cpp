#include "experiments/paper/timed_training.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <ATen/ATen.h>

#include "lte/base/check.h"

namespace lte::experiments {

int64_t train_for(const TimedTraining& training, torch::optim::Optimizer& optimizer,
                  const std::function<at::Tensor()>& loss,
                  const std::function<void(int64_t step, double used)>& after) {
  constexpr double kLastRate = 0.01;  // of the first
  int64_t steps = 0;
  double used = 0;
  while (used < training.seconds) {
    const std::clock_t begin = std::clock();
    const double share = std::min(1.0, used / training.seconds);
    const double fall = kLastRate + (1 - kLastRate) * 0.5 * (1 + std::cos(M_PI * share));
    for (auto& group : optimizer.param_groups()) group.options().set_lr(training.rate * fall);
    optimizer.zero_grad();
    const at::Tensor value = loss();
    LTE_CHECK(std::isfinite(value.item<double>()), "step ", steps + 1, ": the loss is not finite");
    value.backward();
    optimizer.step();
    ++steps;
    used += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (after) after(steps, used);
  }
  return steps;
}

}  // namespace lte::experiments
