// The models a run leaves for others to use: the last one and the best one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lte/nn/model.h"
#include "train/data/light_estimates.h"
#include "train/optim/optimizer.h"

namespace lte::train {

/// Where a model comes from: what its metadata say beside its own configuration.
struct ModelOrigin {
  std::string config;  ///< the run's whole configuration, YAML
  int64_t step = 0;
  int64_t scene_points = 0;  ///< M, points of a scene that it was trained on
  bool pruned = false;       ///< points were drawn only where light reaches them
  bool suns = false;         ///< some scenes had directional lights
  LightEstimates light;      ///< of the data set; written if the model reads them
  std::optional<double> val_loss;
};

/// Writes the averaged weights if there are any, else the weights. Atomic.
void save_run_model(const std::filesystem::path& path, const nn::LightTransportModel& model,
                    Optimizer* optimizer, const ModelOrigin& origin);

/// Makes the same file from a checkpoint, whose metadata give the model's shape.
void save_model_of_checkpoint(const std::filesystem::path& path,
                              const std::filesystem::path& checkpoint, const OptimConfig& config,
                              const ModelOrigin& origin);

/// The step whose model is in `path`; nothing if it is missing or damaged.
std::optional<int64_t> step_of_model(const std::filesystem::path& path);

}  // namespace lte::train
