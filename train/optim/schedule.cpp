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
  const auto falling =
      static_cast<int64_t>(std::llround(config.decay_share * static_cast<double>(config.steps)));
  const int64_t first = std::max(config.warmup_steps, config.steps - falling);
  const int64_t last = std::max<int64_t>(config.steps - 1 - first, 1);
  const double progress =
      std::clamp(static_cast<double>(step - first) / static_cast<double>(last), 0.0, 1.0);
  const double above = config.learning_rate - config.min_learning_rate;
  return config.min_learning_rate + above * 0.5 * (1 + std::cos(std::numbers::pi * progress));
}

double ema_decay(const OptimConfig& config, int64_t step) {
  return std::min(config.ema_decay, static_cast<double>(1 + step) / static_cast<double>(10 + step));
}

}  // namespace lte::train
