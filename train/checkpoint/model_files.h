// The models a run leaves for others to use: the last one and the best one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lte/nn/model.h"
#include "train/optim/optimizer.h"

namespace lte::train {

/// What stands in a model's metadata beside its own configuration.
struct ModelOrigin {
  std::string config;  ///< of the run, YAML
  int64_t step = 0;
  int64_t scene_points = 0;  ///< M it was trained on
  bool pruned = false;       ///< points were drawn only where light reaches them
  std::optional<double> val_loss;
};

/// The averaged weights if there are any. Atomic.
void save_run_model(const std::filesystem::path& path, const nn::LightTransportModel& model,
                    Optimizer* optimizer, const ModelOrigin& origin);

/// The same from a checkpoint, whose metadata decide over the model's shape.
void save_model_of_checkpoint(const std::filesystem::path& path,
                              const std::filesystem::path& checkpoint, const OptimConfig& config,
                              const ModelOrigin& origin);

/// The step whose model is in `path`; nothing if it is missing or damaged.
std::optional<int64_t> step_of_model(const std::filesystem::path& path);

}  // namespace lte::train
