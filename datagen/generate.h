// A data set of procedural rooms: generated, baked and listed, in shards if wanted, and resumed
// after a stop.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "datagen/config.h"

namespace lte::datagen {

struct GenerateOptions {
  std::filesystem::path out;
  /// This run bakes the scenes with index % shard_count == shard_index.
  int64_t shard_index = 0, shard_count = 1;
  bool resume = false;  ///< keep the valid scenes that are there
  bool glb = false;     ///< also write scenes/NAME.glb
};

struct GenerateResult {
  int64_t baked = 0, kept = 0;  ///< by this run
  int64_t listed = 0;           ///< scenes in dataset.json at the end
  double seconds = 0;
};

/// Makes `out`/dataset.json, config.yaml and scenes/. Files are the same bytes for the same
/// configuration, whatever the number of threads, shards and interruptions; runs of several shards
/// may share `out` at the same time. Each scene appears whole or not at all, so a run that is
/// killed loses the scene in work and nothing else.
/// @throws lte::Error if `out` is not empty and not a data set of this configuration, or holds
/// scenes of this shard
///         and `resume` is not set, or a file cannot be written.
GenerateResult generate_dataset(const DatagenConfig& config, const GenerateOptions& options);

/// The scene that the configured generator makes of a seed.
scene::Scene generate_scene(const DatagenConfig& config, uint64_t seed, const std::string& name);

/// "room_00042".
std::string scene_name(int64_t index);
/// The seed that makes scene `index` of a data set.
uint64_t scene_seed(uint64_t dataset_seed, int64_t index);

}  // namespace lte::datagen
