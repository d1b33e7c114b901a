// The training loop.
//
// A step takes its scenes in passes of `train.scenes_per_pass` and adds up their gradients. No
// scene sees another, and memory grows with threads and the scenes of a pass, not with
// scenes_per_step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lte/base/timer.h"
#include "train/checkpoint/checkpoint_files.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/distributed/process_group.h"
#include "train/loop/preview.h"
#include "train/loop/run_state.h"
#include "train/loop/scene_gradients.h"
#include "train/loop/session_log.h"
#include "train/loop/validate.h"

namespace lte::train {

struct TrainSummary {
  int64_t step = 0;        ///< steps done, over all sessions
  double loss = 0;         ///< of the last step of this session
  double best_loss = 0;    ///< lowest validation loss; infinite if there was none
  double seconds = 0;      ///< over all sessions
  double wait_share = 0;   ///< of this session's time: spent waiting for examples
  int64_t bad_scenes = 0;  ///< of both splits, met and skipped in this session by any process
  int signal = 0;          ///< that ended the run early; 0 if it came to its end
  std::optional<ValidationResult> validation;  ///< the last of this session
};

/// Of the steps since it was last taken: one step's loss is that of a few scenes.
class MeanLoss {
 public:
  void add(double loss) {
    sum_ += loss;
    ++steps_;
  }
  double take() {
    const double mean = sum_ / static_cast<double>(steps_);
    *this = MeanLoss();
    return mean;
  }

 private:
  double sum_ = 0;
  int64_t steps_ = 0;
};

class Trainer {
 public:
  /// Opens the data, and makes the model or takes it from the run's newest whole checkpoint.
  /// @param config_text  the whole configuration as YAML, kept in the checkpoint and the models
  /// @param group  of a run of several processes, which then all make a Trainer; rank 0 alone
  /// writes the run directory, which all must see. Null: this process is alone
  /// @throws lte::Error if there is nothing to resume, the configuration does not fit the
  /// checkpoint, a new run would overwrite one, or another process trains in the directory.
  Trainer(const TrainConfig& config, std::string config_text, at::Device device, bool resume,
          ProcessGroup* group = nullptr);

  /// Trains to the last step, the first signal, or `stop_after` steps of this session, and leaves a
  /// checkpoint and model.safetensors in each case.
  /// @param stop_after  0: no such limit
  /// @throws lte::Error naming step and scene when loss or gradient is not finite, or the rank that
  /// keeps the others from going on; the last checkpoint stays.
  TrainSummary run(int64_t stop_after = 0);

 private:
  bool leads() const { return !group_ || group_->rank().leads(); }
  int told_to_stop() const;
  void train_steps(int64_t end);
  void train_step();
  void add_up(double* loss, int64_t* queries);
  void after_step(double norm, const ModuleGradients& modules);
  NamedValues health();
  bool validate_now();
  void draw_previews();
  void save();
  ModelOrigin origin() const;
  void finish();

  TrainConfig config_;
  std::string config_text_;
  at::Device device_;
  ProcessGroup* group_;
  std::filesystem::path output_;
  CheckpointFiles files_;
  RunData data_;
  RunState state_;
  std::unique_ptr<SceneGradients> gradients_;
  std::unique_ptr<SessionLog> log_;  ///< of rank 0
  std::unique_ptr<BatchLoader> loader_;
  std::vector<Example> validation_;
  std::unique_ptr<Previews> previews_;  ///< of rank 0, unless switched off
  TrainSummary summary_;
  MeanLoss since_validation_;
  double seconds_before_ = 0;  ///< of earlier sessions
  Timer session_timer_;
  int agreed_signal_ = 0;    ///< that any process of a group was sent
  int64_t saved_step_ = -1;  ///< of this session's last checkpoint
};

}  // namespace lte::train
