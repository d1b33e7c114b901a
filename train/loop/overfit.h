// The first question to a network, its data and its settings: can it learn one scene by heart?
#pragma once

#include <cstdint>
#include <string>

#include <c10/core/Device.h>

#include "train/config.h"

namespace lte::train {

/// The PSNR, in dB, that a sound network reaches on queries that it trains on.
inline constexpr double kOverfitPsnr = 45;

struct OverfitResult {
  std::string scene;
  int64_t steps = 0, queries = 0;
  double psnr = 0;  ///< as in ValidationResult, on the queries that it trained on
  double loss = 0;  ///< on the same queries
  bool reached() const { return psnr >= kOverfitPsnr; }
};

/// Trains on the first usable scene of the training split, with the same points and queries in each
/// step, and with neither augmentation nor dropout. Curve orders change from step to step. It ends
/// when kOverfitPsnr is reached, at the latest after train.steps, and writes nothing.
/// @throws lte::Error as Trainer does for its data and its first model, or if loss or gradient is
/// not finite
OverfitResult overfit_one_scene(const TrainConfig& config, at::Device device);

}  // namespace lte::train
