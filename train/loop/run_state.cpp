#include "train/loop/run_state.h"

#include <cmath>
#include <filesystem>
#include <limits>

#include <ATen/ops/tensor.h>
#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/nn/files/model_file.h"
#include "train/checkpoint/first_model.h"
#include "train/loop/config_changes.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

void check_fits(const fs::path& path, const CheckpointHeader& header, const RunStart& start) {
  const std::vector<std::string> differences = model_differences(start.config.model, header.model);
  LTE_CHECK(differences.empty(), path.string(),
            ": cannot resume, as the configuration differs in model.", joined(differences));
  LTE_CHECK(header.model.scale == start.data.scale, path.string(),
            ": cannot resume, as its scale is ", header.model.scale, " m and the data set's ",
            start.data.scale, " m");
  check_light_estimates(path.string(), header.model, header.progress.light, start.data.light);
  LTE_CHECK(header.progress.seed == start.config.seed, path.string(),
            ": cannot resume, as its seed is ", header.progress.seed, " and the configuration's ",
            start.config.seed);
  if (header.progress.data_fingerprint != start.data.fingerprint) {
    log_warning(start.config.data.root,
                ": the training split is not the one of the checkpoint; the run goes on with it");
  }
}

/// The best model is written when it is found and never again: what has become of it since is put
/// right from the checkpoint of the same step.
void mend_best_model(const RunStart& start, RunProgress* progress) {
  if (!std::isfinite(progress->best_loss) || progress->best_step < 0) return;
  const fs::path path = best_model_path(start.config.output);
  // A later one is that of a future which this run, going on from an older checkpoint, meets again.
  const std::optional<int64_t> step = step_of_model(path);
  if (step && (*step == progress->best_step || *step > progress->step)) return;
  const auto checkpoint = start.files.whole_of_step(progress->best_step);
  if (!checkpoint) {
    log_warning(path.string(), ": damaged or missing, and no checkpoint of step ",
                progress->best_step, " is left; the next validation starts it anew");
    progress->best_loss = std::numeric_limits<double>::infinity();
    return;
  }
  log_warning(path.string(), ": damaged or missing; made again from ", checkpoint->string());
  save_model_of_checkpoint(path, *checkpoint, start.config.train,
                           model_origin(start.config, start.config_text, start.data,
                                        progress->best_step, progress->best_loss));
}

/// The weights that the run began with, from their file; null if that is gone or damaged.
std::unique_ptr<WeightMovement> movement_since_start(const fs::path& output) {
  const fs::path path = start_path(output);
  if (!fs::exists(path)) return nullptr;
  try {
    return std::make_unique<WeightMovement>(nn::load_model(path));
  } catch (const Error& error) {
    log_warning(error.what(), "; how far weights have moved is not logged");
    return nullptr;
  }
}

}  // namespace

RunState start_run(const RunStart& start) {
  const fs::path output = start.config.output;
  LTE_CHECK(
      !start.files.any(), checkpoint_path(output).string(),
      ": a run is there already; go on with --resume, or choose another directory with --out");
  RunState state;
  state.model = first_model(&start.config, &start.data);
  if (start.leads) state.lock = std::make_unique<RunLock>(output);
  state.model->to(start.device);
  state.optimizer = std::make_unique<Optimizer>(start.config.train, state.model);
  state.progress.seed = start.config.seed;
  state.progress.light = start.data.light;
  state.progress.data_fingerprint = start.data.fingerprint;
  if (start.leads) state.movement = std::make_unique<WeightMovement>(state.model);
  return state;
}

RunState resume_run(const RunStart& start) {
  RunState state;
  if (start.leads && start.files.any()) state.lock = std::make_unique<RunLock>(start.config.output);
  const fs::path path = start.files.newest_whole(/*warn=*/start.leads);
  const CheckpointHeader header = read_checkpoint_header(path);
  check_fits(path, header, start);
  state.progress = header.progress;
  state.progress.data_fingerprint = start.data.fingerprint;
  state.log = header.log;
  start.config.model = header.model;
  state.model = nn::LightTransportModel(start.config.model);
  state.model->to(start.device);
  state.optimizer = std::make_unique<Optimizer>(start.config.train, state.model);
  load_checkpoint(path, state.model, state.optimizer.get());
  if (start.leads) {
    mend_best_model(start, &state.progress);
    state.movement = movement_since_start(start.config.output);
    for (const std::string& change : config_changes(header.config, start.config_text))
      log_info("changed from here on: ", change);
  }
  log_info("resumed ", path.string(), " at step ", state.progress.step, " of ",
           start.config.train.steps);
  return state;
}

void agree_on_start(const RunStart& start, const RunState& state, ProcessGroup& group) {
  const auto mine = at::tensor({state.progress.step, static_cast<int64_t>(start.data.fingerprint),
                                static_cast<int64_t>(start.config.train.steps)},
                               at::kLong);
  at::Tensor leaders = mine.to(start.device, /*non_blocking=*/false, /*copy=*/true);
  group.broadcast({leaders});
  leaders = leaders.cpu();
  const auto differs = [&](int64_t i) {
    return mine[i].item<int64_t>() != leaders[i].item<int64_t>();
  };
  const int rank = group.rank().index;
  LTE_CHECK(!differs(0), start.config.output, ": rank ", rank, " starts at step ",
            state.progress.step, " and rank 0 at ", leaders[0].item<int64_t>(),
            "; the run directory must be one that all processes see");
  LTE_CHECK(!differs(1), start.config.data.root, ": the training split of rank ", rank,
            " is not that of rank 0");
  LTE_CHECK(!differs(2), "train.steps: rank ", rank, " has ", start.config.train.steps,
            " and rank 0 ", leaders[2].item<int64_t>());
  group.broadcast(state.model->parameters());
}

ModelOrigin model_origin(const TrainConfig& config, const std::string& config_text,
                         const RunData& data, int64_t step, std::optional<double> val_loss) {
  return {config_text, step,    config.data.scene_points, data.pruned, data.suns,
          data.light,  val_loss};
}

}  // namespace lte::train
