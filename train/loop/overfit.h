// The first question to a network, its data and its settings: can it learn one scene by heart?
#pragma once

#include <cstdint>
#include <string>

#include <c10/core/Device.h>

#include "train/config.h"

namespace lte::train {

/// What a sound network reaches on queries that it trains on, dB below the scene's largest value.
inline constexpr double kOverfitPsnr = 45;

struct OverfitResult {
  std::string scene;
  int64_t steps = 0, queries = 0;
  double psnr = 0;  ///< as ValidationResult has it, on the very queries
  double loss = 0;  ///< likewise
  bool reached() const { return psnr >= kOverfitPsnr; }
};

/// Trains on the first usable scene of the training split: the same points and queries in each
/// step, neither augmentation nor dropout; curve orders change from step to step. Ends when
/// kOverfitPsnr is reached, at the latest after train.steps. Writes nothing.
/// @throws lte::Error as Trainer does for its data and its first model, or if the loss is not
/// finite
OverfitResult overfit_one_scene(const TrainConfig& config, at::Device device);

}  // namespace lte::train
