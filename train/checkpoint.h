// What a run needs to go on: weights, optimizer state and progress in one file, so that they cannot
// come from two steps.
//
// Random numbers need no state: examples, dropout and curve orders are functions of (seed, step).
// Learning rate and averaging rate are functions of the step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "lte/nn/model.h"
#include "train/optimizer.h"

namespace lte::train {

/// What is neither weight nor moment.
struct RunProgress {
  int64_t step = 0;  ///< steps done
  uint64_t seed = 0;
  double best_loss = std::numeric_limits<double>::infinity();  ///< lowest validation loss so far
  double seconds = 0;             ///< spent training, over all sessions
  double window_loss = 0;         ///< sum of losses since the last line of the log
  int64_t window_steps = 0;       ///< steps in it
  uint64_t data_fingerprint = 0;  ///< of the training split's scene names, in order
};

struct CheckpointHeader {
  RunProgress progress;
  nn::ModelConfig model;
  std::string config;  ///< the run's whole configuration, YAML
};

std::filesystem::path checkpoint_path(const std::filesystem::path& run);
std::filesystem::path model_path(const std::filesystem::path& run);
std::filesystem::path best_model_path(const std::filesystem::path& run);

/// Atomic. Tensors: "model.NAME" and Optimizer::state(). Metadata: format "lte-checkpoint",
/// format_version, progress (JSON), model_config and config (YAML), lte_version.
void save_checkpoint(const std::filesystem::path& path, const nn::LightTransportModel& model,
                     const Optimizer& optimizer, const RunProgress& progress,
                     const std::string& config);

/// @throws lte::Error naming the file: unreadable, not a checkpoint, of a newer format.
CheckpointHeader read_checkpoint_header(const std::filesystem::path& path);

/// Weights and optimizer state into a model built from the header's configuration.
/// @throws lte::Error naming file and tensor if one is missing, of another shape or not finite.
void load_checkpoint(const std::filesystem::path& path, const nn::LightTransportModel& model,
                     Optimizer* optimizer);

}  // namespace lte::train
