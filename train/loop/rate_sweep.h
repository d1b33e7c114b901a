// The learning-rate range test (Smith 2017, Cyclical Learning Rates, section 3.3): a short training
// whose rate grows from step to step shows where the loss falls fastest and where it blows up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <c10/core/Device.h>

#include "train/config.h"

namespace lte::train {

struct RatePoint {
  double rate = 0;      ///< learning rate of the step
  double loss = 0;      ///< before the step, mean over its scenes
  double smoothed = 0;  ///< exponential mean of the losses so far, free of the start's bias
};

struct RateSweep {
  std::vector<RatePoint> points;  ///< by rising rate; ends early where the loss has blown up
  bool diverged = false;          ///< whether it has
  double steepest = 0;            ///< rate where the smoothed loss falls fastest per factor of rate
  double lowest = 0;              ///< rate where the smoothed loss is lowest
  double suggestion = 0;  ///< for train.learning_rate: the smaller of steepest and lowest/10
};

inline constexpr double kLowestRate = 1e-6, kHighestRate = 1;

/// Reads off `points`, of which there are at least three, what they say.
RateSweep read_sweep(std::vector<RatePoint> points, bool diverged);

/// Trains the model that a run would begin with, on the examples that it would have, in this
/// process alone. The rate grows from kLowestRate to kHighestRate by equal factors over `steps`
/// steps. The sweep ends early when the smoothed loss is four times its lowest value or no number
/// any more.
/// @throws lte::Error as Trainer does for its data and its first model
RateSweep sweep_rates(const TrainConfig& config, at::Device device, int64_t steps);

/// Writes a JSON object a line: step, lr, loss, smoothed_loss. Atomic.
void write_sweep(const std::filesystem::path& path, const RateSweep& sweep);

}  // namespace lte::train
