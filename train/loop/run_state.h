// What the steps of a run change, and how it begins: anew, or where its last checkpoint left it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lte/nn/model.h"
#include "train/checkpoint/checkpoint.h"
#include "train/checkpoint/checkpoint_files.h"
#include "train/checkpoint/model_files.h"
#include "train/config.h"
#include "train/data/run_data.h"
#include "train/distributed/process_group.h"
#include "train/loop/run_lock.h"
#include "train/optim/optimizer.h"
#include "train/optim/weight_movement.h"

namespace lte::train {

struct RunState {
  std::unique_ptr<RunLock> lock;  ///< of rank 0: who holds it writes the run directory
  nn::LightTransportModel model{nullptr};
  std::unique_ptr<Optimizer> optimizer;
  RunProgress progress;
  std::unique_ptr<WeightMovement> movement;  ///< of rank 0; null: the first weights are lost
  std::optional<std::string>
      log;  ///< log.jsonl, as the checkpoint that the run goes on from has it
};

/// What a run begins with; all of it outlives the call.
struct RunStart {
  TrainConfig& config;  ///< its model gets what the data or the checkpoint decide
  const std::string& config_text;
  RunData& data;
  CheckpointFiles& files;
  at::Device device;
  bool leads;  ///< whether this is rank 0, which alone writes
};

/// Makes the first model and the run directory, which stays untouched if the model cannot be made.
/// @throws lte::Error if the directory holds a run already, if another process trains in it, or as
/// first_model()
RunState start_run(const RunStart& start);

/// Takes everything from the newest whole checkpoint, and makes the best model again if it is
/// damaged. Says, a line each, which keys of the configuration differ from the checkpoint's.
/// @throws lte::Error if there is none, if configuration or data set do not fit it, or if another
/// process trains in the directory
RunState resume_run(const RunStart& start);

/// Makes sure that all processes have read the same data set and checkpoint, and gives all of them
/// the weights of rank 0.
/// @throws lte::Error naming the rank that differs
void agree_on_start(const RunStart& start, const RunState& state, ProcessGroup& group);

/// What the metadata of a model of this run say.
ModelOrigin model_origin(const TrainConfig& config, const std::string& config_text,
                         const RunData& data, int64_t step, std::optional<double> val_loss);

}  // namespace lte::train
