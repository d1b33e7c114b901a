// The data set as a run sees it: its splits, and what of the model's configuration it decides.
#pragma once

#include <cstdint>
#include <string>

#include "lte/data/dataset.h"
#include "train/config.h"
#include "train/data/light_estimates.h"
#include "train/data/scene_store.h"

namespace lte::train {

struct RunData {
  double scale = 0;     ///< s, metres
  bool pruned = false;  ///< points were drawn only where light reaches them
  bool suns = false;    ///< some scenes have directional lights
  LightEstimates light;
  SceneStore train, val;  ///< val may be empty
  /// Hash of the names of the training split in their order, on which the order of examples
  /// depends.
  uint64_t fingerprint = 0;
};

/// @throws lte::Error if data.root is missing or is no data set, if its training split is empty, if
/// a scene of either split is a held-out one (lte/data/held_out.h), or if model.scale is given and
/// is not the data set's.
RunData open_run_data(const TrainConfig& config);

/// Reads every scene of both splits once, with all checks.
/// @return a line for people: numbers of scenes, points and queries
/// @throws lte::Error naming file, tensor and index of the first offender, or a scene larger than
///         s.
std::string check_run_data(const TrainConfig& config);

}  // namespace lte::train
