// What a run needs to go on: weights, optimizer state, progress and the log so far in one file, so
// that they cannot come from two steps.
//
// Random numbers need no state: examples, dropout and curve orders are functions of (seed, step).
// Learning rate and averaging rate are functions of the step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "lte/nn/model.h"
#include "train/data/light_estimates.h"
#include "train/optim/optimizer.h"

namespace lte::train {

/// Where a run has got to: all of its state that is neither weight nor moment.
struct RunProgress {
  int64_t step = 0;  ///< steps done
  uint64_t seed = 0;
  double best_loss = std::numeric_limits<double>::infinity();  ///< lowest validation loss so far
  int64_t best_step = -1;         ///< step of that validation; −1: none yet, or not known
  double seconds = 0;             ///< spent training, over all sessions
  double window_loss = 0;         ///< sum of losses since the last line of the log
  int64_t window_steps = 0;       ///< steps in it
  uint64_t data_fingerprint = 0;  ///< of the training split's scene names, in order
  LightEstimates light;           ///< of the data set
};

/// What stands in a checkpoint beside tensors of weights and moments.
struct CheckpointHeader {
  RunProgress progress;
  nn::ModelConfig model;
  std::string config;              ///< the run's whole configuration, YAML
  std::optional<std::string> log;  ///< log.jsonl as it was; files of earlier builds lack it
};

std::filesystem::path checkpoint_path(const std::filesystem::path& run);
std::filesystem::path model_path(const std::filesystem::path& run);
std::filesystem::path best_model_path(const std::filesystem::path& run);
/// The model that the run began with, which tells how far its weights have moved.
std::filesystem::path start_path(const std::filesystem::path& run);

/// Writes the file in one piece or not at all. Its tensors are "model.NAME", Optimizer::state() and
/// "log" (the bytes of log.jsonl). Its metadata are format "lte-checkpoint", format_version,
/// progress (JSON), model_config and config (YAML), and lte_version.
void save_checkpoint(const std::filesystem::path& path, const nn::LightTransportModel& model,
                     const Optimizer& optimizer, const RunProgress& progress,
                     const std::string& config, const std::string& log);

/// Reads the whole file against its checksum.
/// @return what is wrong with it (truncated, empty, foreign, bytes changed); nothing if it is whole
/// @throws lte::Error if it is of another format version, which is no damage
std::optional<std::string> checkpoint_damage(const std::filesystem::path& path);

/// @throws lte::Error naming the file: unreadable, not a checkpoint, of another format version.
CheckpointHeader read_checkpoint_header(const std::filesystem::path& path);

/// Reads weights and optimizer state into a model built from the header's configuration.
/// @throws lte::Error naming file and tensor if one is missing, of another shape or not finite.
void load_checkpoint(const std::filesystem::path& path, const nn::LightTransportModel& model,
                     Optimizer* optimizer);

}  // namespace lte::train
