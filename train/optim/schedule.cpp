#include "train/optim/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lte::train {

double learning_rate(const OptimConfig& config, int64_t step) {
  if (step < config.warmup_steps) {
    return config.learning_rate * static_cast<double>(step + 1) /
           static_cast<double>(config.warmup_steps);
  }
  const int64_t last = std::max<int64_t>(config.steps - 1 - config.warmup_steps, 1);
  const double progress =
      std::min(1.0, static_cast<double>(step - config.warmup_steps) / static_cast<double>(last));
  const double above = config.learning_rate - config.min_learning_rate;
  return config.min_learning_rate + above * 0.5 * (1 + std::cos(std::numbers::pi * progress));
}

double ema_decay(const OptimConfig& config, int64_t step) {
  return std::min(config.ema_decay, static_cast<double>(1 + step) / static_cast<double>(10 + step));
}

}  // namespace lte::train
