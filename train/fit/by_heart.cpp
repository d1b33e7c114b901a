#include "train/fit/by_heart.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <torch/optim/adam.h>
#include <torch/types.h>

#include "lte/nn/loss.h"

namespace lte::train {
namespace {

constexpr double kLastRate = 0.01;  ///< of the first

double rate_factor(double share) {
  return kLastRate + (1 - kLastRate) * 0.5 * (1 + std::cos(std::numbers::pi * share));
}

}  // namespace

int64_t learn_by_heart(const ByHeart& task, const ByHeartLimits& limits,
                       const std::function<bool(int64_t steps, double seconds)>& look) {
  torch::optim::Adam optimizer(task.parameters, torch::optim::AdamOptions(limits.rate).eps(1e-12));
  const nn::LossConfig loss = {
      .epsilon = limits.epsilon, .detach_denominator = true, .space = nn::LossSpace::Linear};
  int64_t steps = 0;
  double seconds = 0;
  while (seconds < limits.seconds && steps < limits.steps) {
    const double begin = limits.clock();
    const at::Tensor rows =
        task.learnt.index_select(0, at::randint(task.learnt.size(0), {limits.batch}, at::kLong));
    const double share = std::max(seconds / limits.seconds,
                                  static_cast<double>(steps) / static_cast<double>(limits.steps));
    for (auto& group : optimizer.param_groups())
      group.options().set_lr(limits.rate * rate_factor(share));
    optimizer.zero_grad();
    nn::relative_loss(task.answer(rows), task.target.index_select(0, rows), loss).backward();
    optimizer.step();
    ++steps;
    seconds += limits.clock() - begin;
    if (!look(steps, seconds)) break;
  }
  return steps;
}

}  // namespace lte::train
