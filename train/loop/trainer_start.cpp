// How a run begins: anew, or where its last checkpoint left it.
#include <cmath>
#include <limits>

#include <ATen/ops/tensor.h>
#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "train/checkpoint/first_model.h"
#include "train/loop/trainer.h"

namespace lte::train {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

}  // namespace

/// Two writers would mix two runs in one directory: a batch system that starts a job again while
/// the first still runs, say.
void Trainer::hold_directory() {
  if (!leads()) return;
  lock_ = std::make_unique<LockedFile>(output_ / ".lock");
  LTE_CHECK(!lock_->busy(), output_.string(),
            ": another lte_train runs in this directory; end it, or choose another with --out");
  remove_leftovers(output_);
}

void Trainer::start_new() {
  LTE_CHECK(
      !files_.any(), checkpoint_path(output_).string(),
      ": a run is there already; go on with --resume, or choose another directory with --out");
  std::error_code error;
  if (leads()) std::filesystem::create_directories(output_, error);
  LTE_CHECK(!error, output_.string(), ": cannot create the run directory: ", error.message());
  hold_directory();
  model_ = first_model(&config_, &data_);
  model_->to(device_);
  optimizer_ = std::make_unique<Optimizer>(config_.train, model_);
  progress_.seed = config_.seed;
  progress_.data_fingerprint = data_.fingerprint;
}

void Trainer::resume() {
  if (files_.any()) hold_directory();
  const std::filesystem::path path = files_.newest_whole(/*warn=*/leads());
  const CheckpointHeader header = read_checkpoint_header(path);
  const std::vector<std::string> differences = model_differences(config_.model, header.model);
  LTE_CHECK(differences.empty(), path.string(),
            ": cannot resume, as the configuration differs in model.", joined(differences));
  LTE_CHECK(header.model.scale == data_.scale, path.string(), ": cannot resume, as its scale is ",
            header.model.scale, " m and the data set's ", data_.scale, " m");
  LTE_CHECK(header.progress.seed == config_.seed, path.string(), ": cannot resume, as its seed is ",
            header.progress.seed, " and the configuration's ", config_.seed);
  if (header.progress.data_fingerprint != data_.fingerprint) {
    log_warning(config_.data.root,
                ": the training split is not the one of the checkpoint; the run goes on with it");
  }
  progress_ = header.progress;
  saved_log_ = header.log;
  progress_.data_fingerprint = data_.fingerprint;
  config_.model = header.model;
  model_ = nn::LightTransportModel(config_.model);
  model_->to(device_);
  optimizer_ = std::make_unique<Optimizer>(config_.train, model_);
  load_checkpoint(path, model_, optimizer_.get());
  summary_.step = progress_.step;
  if (leads()) mend_best_model();
  log_info("resumed ", path.string(), " at step ", progress_.step, " of ", config_.train.steps);
}

/// The best model is written when it is found and never again: what has become of it since is put
/// right from the checkpoint of the same step.
void Trainer::mend_best_model() {
  if (!std::isfinite(progress_.best_loss) || progress_.best_step < 0) return;
  const std::filesystem::path path = best_model_path(output_);
  // A later one is that of a future which this run, going on from an older checkpoint, meets again.
  const std::optional<int64_t> step = step_of_model(path);
  if (step && (*step == progress_.best_step || *step > progress_.step)) return;
  const auto checkpoint = files_.whole_of_step(progress_.best_step);
  if (!checkpoint) {
    log_warning(path.string(), ": damaged or missing, and no checkpoint of step ",
                progress_.best_step, " is left; the next validation starts it anew");
    progress_.best_loss = std::numeric_limits<double>::infinity();
    return;
  }
  log_warning(path.string(), ": damaged or missing; made again from ", checkpoint->string());
  ModelOrigin of_best = origin();
  of_best.step = progress_.best_step;
  of_best.val_loss = progress_.best_loss;
  save_model_of_checkpoint(path, *checkpoint, config_.train, of_best);
}

/// All processes must have read the same data set and checkpoint; the weights are those of rank 0.
void Trainer::agree_on_start() {
  const auto mine = at::tensor({progress_.step, static_cast<int64_t>(data_.fingerprint),
                                static_cast<int64_t>(config_.train.steps)},
                               at::kLong);
  at::Tensor leaders = mine.to(device_, /*non_blocking=*/false, /*copy=*/true);
  group_->broadcast({leaders});
  leaders = leaders.cpu();
  const auto differs = [&](int64_t i) {
    return mine[i].item<int64_t>() != leaders[i].item<int64_t>();
  };
  LTE_CHECK(!differs(0), output_.string(), ": rank ", group_->world().rank, " starts at step ",
            progress_.step, " and rank 0 at ", leaders[0].item<int64_t>(),
            "; the run directory must be one that all processes see");
  LTE_CHECK(!differs(1), config_.data.root, ": the training split of rank ", group_->world().rank,
            " is not that of rank 0");
  LTE_CHECK(!differs(2), "train.steps: rank ", group_->world().rank, " has ", config_.train.steps,
            " and rank 0 ", leaders[2].item<int64_t>());
  group_->broadcast(model_->parameters());
}

}  // namespace lte::train
