// What a configuration amounts to, without data and without training: parameters, shapes, memory.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "lte/nn/model.h"
#include "train/config.h"

namespace lte::train {

/// Bytes that a training process needs, by kind (lte/nn/cost.h). Weights and moments are exact.
/// Activations are what the backward pass of one scene keeps, and hold to about a third.
struct MemoryEstimate {
  double weights = 0, gradients = 0, moments = 0, average = 0;
  double activations = 0;
  /// Scene points, queries and reference of two steps: this one, and the next, which is being made.
  double examples = 0;
  double scene_cache = 0;  ///< at most: data.cache_mb; less for a small data set
  /// Without the cache, which depends on the data.
  double total() const { return weights + gradients + moments + average + activations + examples; }
};

/// `data.scene_points` or `data.queries_per_scene` of 0 (all) count as the defaults, as the files
/// are not read.
MemoryEstimate estimate_memory(const TrainConfig& config, const nn::LightTransportModel& model);

/// {"parameters":{total,nne,encoder,decoder}, "modules":{..}, "shapes":{..}, "memory_mb":{..},
/// "training":{..}}.
nlohmann::ordered_json dry_run(const TrainConfig& config);

/// The same as a table for people.
std::string dry_run_table(const nlohmann::ordered_json& report);

}  // namespace lte::train
