// Whether all of a trained network works: per stage what its features and attention carry, and per
// module how large its gradients are and how far it has moved.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/nn/encoder/stage_health.h"

namespace lte::train {

struct HealthOptions {
  std::string model{};  ///< model file or checkpoint
  std::string data{};   ///< data set
  std::string start{};  ///< the run's first weights; empty: start.safetensors beside the model
  std::string json{};   ///< where the figures go for machines; empty: nowhere
  int64_t scenes = 4;   ///< of the validation split, or of the training split if that is empty
};

struct ModuleHealth {
  std::string module;  ///< gradient_module()
  double gradient_rms = 0;
  double moved = 0;  ///< |w − w₀| / |w₀|; NaN where the first weights are not known
};

struct HealthReport {
  std::vector<nn::StageHealth> stages;  ///< means over the scenes
  std::vector<ModuleHealth> modules;

  /// A line for each stage that has collapsed and for each module that stands still: moved by less
  /// than a tenth of the median module.
  std::vector<std::string> faults() const;
};

/// @throws lte::Error naming the file: no model, no data set, none of its scenes can be used
HealthReport measure_health(const HealthOptions& options);

}  // namespace lte::train
