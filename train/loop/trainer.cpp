#include "train/loop/trainer.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include <ATen/Parallel.h>
#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/cli/progress.h"
#include "train/loop/interrupt.h"
#include "train/loop/step_gradient.h"

namespace lte::train {
namespace {

constexpr const char* kCheckpointStays = "; the last checkpoint stays, go on from it with --resume";

}  // namespace

Trainer::Trainer(const TrainConfig& config, std::string config_text, at::Device device, bool resume,
                 ProcessGroup* group)
    : config_(config),
      config_text_(std::move(config_text)),
      device_(device),
      group_(group),
      output_(config.output),
      files_(config.output, config.train.keep_checkpoints),
      data_(open_run_data(config)) {
  LTE_CHECK(!config_.output.empty(), "output: names no run directory; give it with --out RUN_DIR");
  const Rank rank = group_ ? group_->rank() : Rank{};
  LTE_CHECK(config_.train.scenes_per_step >= rank.count,
            "train.scenes_per_step: ", config_.train.scenes_per_step,
            " scenes cannot be shared out among ", rank.count,
            " processes; it counts those of all processes together");
  config_.model.scale = data_.scale;
  const RunStart start{config_, config_text_, data_, files_, device_, leads()};
  state_ = resume ? resume_run(start) : start_run(start);
  summary_.step = state_.progress.step;
  state_.model->train();
  if (group_) agree_on_start(start, state_, *group_);
  gradients_ = std::make_unique<SceneGradients>(config_, state_.model, device_, group_);
  const int makers = device_.is_cpu() ? 1 : at::get_num_threads();
  loader_ = std::make_unique<BatchLoader>(config_, data_.scale, &data_.train, rank, makers);
  seconds_before_ = state_.progress.seconds;
  if (!leads()) return;
  validation_ = validation_examples(config_, &data_.val);
  if (validation_.empty())
    log_warning(config_.data.root, ": the split \"val\" is empty; the run is not validated");
  if (config_.train.preview_every > 0) previews_ = std::make_unique<Previews>(config_, validation_);
  // Last: a start that fails leaves nothing.
  log_ = std::make_unique<SessionLog>(config_, state_.progress, state_.log);
  state_.log.reset();  // of the size of the log, and read
  write_file(output_ / "config.yaml", config_text_);
  state_.lock->keep();
}

/// The signal that ends the run early, or 0. All processes of a group must answer alike.
int Trainer::told_to_stop() const { return group_ ? agreed_signal_ : interrupt_signal(); }

TrainSummary Trainer::run(int64_t stop_after) {
  const InterruptGuard guard;
  const int64_t first = state_.progress.step, steps = config_.train.steps;
  const int64_t end = stop_after > 0 ? std::min(first + stop_after, steps) : steps;
  if (first >= steps) {
    // The end of an earlier session may have been cut off between the checkpoint and the model
    // made from it.
    log_info(output_.string(), ": all ", steps, " steps were done before");
    if (leads())
      save_run_model(model_path(output_), state_.model, state_.optimizer.get(), origin());
  } else {
    train_steps(end);
  }
  finish();
  summary_.step = state_.progress.step;
  summary_.best_loss = state_.progress.best_loss;
  summary_.seconds = state_.progress.seconds;
  if (state_.progress.step < end) summary_.signal = told_to_stop();
  return summary_;
}

/// Says what the session's data were like.
void Trainer::finish() {
  const double session = state_.progress.seconds - seconds_before_;
  if (session > 0) {
    summary_.wait_share = loader_->waited_seconds() / session;
    if (leads()) log_info("waited for data: ", 100 * summary_.wait_share, " % of the time");
  }
  loader_.reset();  // its thread uses the store
  std::vector<double> met(data_.train.size(), 0.0);
  for (const size_t index : data_.train.bad()) met[index] = 1;
  if (group_ && config_.data.on_bad_scene == BadScene::Skip) met = group_->sum(met);
  const auto bad = std::count_if(met.begin(), met.end(), [](double times) { return times > 0; });
  summary_.bad_scenes = bad + static_cast<int64_t>(data_.val.bad().size());
  if (leads() && summary_.bad_scenes > 0)
    log_warning(config_.data.root, ": ", bad, " of ", data_.train.size(), " training scenes and ",
                data_.val.bad().size(), " validation scenes could not be used and were skipped");
}

void Trainer::train_steps(int64_t end) {
  lte::Progress line("training", end - state_.progress.step, "steps");
  // Only now, when nothing can fail any more that leaves the run directory as it was.
  if (leads() && state_.progress.step == 0)
    save_run_model(start_path(output_), state_.model, state_.optimizer.get(), origin());
  session_timer_.restart();
  if (log_) log_->begin();
  try {
    while (state_.progress.step < end && told_to_stop() == 0) {
      train_step();
      line.advance();
    }
    if (leads() && saved_step_ != state_.progress.step) save();
  } catch (const DiskFull& error) {  // of a model or a picture; save() speaks for itself
    throw Error(concat(error.what(), kCheckpointStays));
  }
  // Rank 0 keeps the store: it must not leave before the others.
  if (group_) group_->wait_for_all();
}

void Trainer::train_step() {
  RunProgress& progress = state_.progress;
  if (group_) group_->begin_step(progress.step + 1);
  const std::vector<Example> examples = loader_->take(progress.step);
  const StepGradient gradient =
      step_gradient(examples, progress.step, gradients_.get(), state_.optimizer.get());
  double loss = gradient.loss;
  int64_t queries = 0;
  for (const Example& example : examples) queries += example.target.size(0);
  if (group_) add_up(&loss, &queries);
  if (!std::isfinite(gradient.norm))
    fail_on_gradient(examples, progress.step, gradients_.get(), state_.optimizer.get());
  // Before the update clips the gradient.
  ModuleGradients modules;
  if (log_ && log_->writes_at(progress.step + 1))
    modules = {state_.optimizer->module_norms(), state_.optimizer->module_rms()};
  state_.optimizer->update(progress.step, gradient.norm);
  progress.step += 1;
  progress.window_loss += loss;
  progress.window_steps += 1;
  progress.seconds = seconds_before_ + session_timer_.seconds();
  summary_.loss = loss;
  since_validation_.add(loss);
  if (!log_) return;
  log_->add_queries(queries);
  after_step(gradient.norm, modules);
}

/// Makes loss and queries of this process those of all processes. A signal to one of them ends all
/// after the same step.
void Trainer::add_up(double* loss, int64_t* queries) {
  const int signal = interrupt_signal();
  const std::vector<double> sums =
      group_->sum({*loss, static_cast<double>(*queries), signal == SIGINT ? 1.0 : 0.0,
                   signal == SIGTERM ? 1.0 : 0.0});
  *loss = sums[0];
  *queries = static_cast<int64_t>(sums[1]);
  agreed_signal_ = sums[2] > 0 ? SIGINT : sums[3] > 0 ? SIGTERM : 0;
}

/// What rank 0 does between two steps.
void Trainer::after_step(double norm, const ModuleGradients& modules) {
  const int64_t step = state_.progress.step;
  const OptimConfig& train = config_.train;
  const auto due = [&](int64_t every) { return step % every == 0 || step == train.steps; };
  if (log_->writes_at(step))
    log_->write_step(&state_.progress, norm, modules, loader_->waited_seconds());
  const bool best = due(train.validate_every) && validate_now();
  if (previews_ && due(train.preview_every)) draw_previews();
  if (due(train.checkpoint_every) || best) save();
  if (best) files_.keep_newest_as_best();
}

void Trainer::draw_previews() {
  if (previews_->empty()) return;
  const Timer timer;
  const int64_t step = state_.progress.step;
  std::vector<PreviewPicture> pictures;
  {
    const AverageScope averaged(state_.optimizer.get());
    pictures = previews_->draw(state_.model, device_);
  }
  write_previews(output_, step, pictures);
  log_->add_pictures(step, pictures);
  log_->write_previews(step, timer.seconds());
}

/// @return whether it is the best so far
bool Trainer::validate_now() {
  if (validation_.empty()) return false;
  const Timer timer;
  RunProgress& progress = state_.progress;
  {
    const AverageScope averaged(state_.optimizer.get());
    summary_.validation = validate(state_.model, validation_, SceneLossConfig(config_), device_);
  }
  log_->write_validation(progress.step, *summary_.validation, timer.seconds(), health());
  const double loss = summary_.validation->loss;
  const bool best = loss < progress.best_loss;
  std::string kinds;
  for (const KindErrors& errors : summary_.validation->kinds)
    kinds += concat(kinds.empty() ? " (" : ", ", errors.kind, " ", errors.loss);
  if (!kinds.empty()) kinds += ")";
  log_info("step ", progress.step, ": loss ", since_validation_.take(), ", validation loss ", loss,
           kinds, ", PSNR ", summary_.validation->psnr, " dB", best ? ", the best so far" : "");
  if (!best) return false;
  progress.best_loss = loss;
  progress.best_step = progress.step;
  save_run_model(best_model_path(output_), state_.model, state_.optimizer.get(), origin());
  return true;
}

/// Of the weights that train, not of their average: the question is what training does.
NamedValues Trainer::health() {
  state_.model->eval();
  const std::vector<nn::StageHealth> stages =
      state_.model->stage_health(validation_.front().to(device_).points);
  state_.model->train();
  return health_fields(stages, state_.movement ? state_.movement->of(state_.model) : NamedValues{});
}

void Trainer::save() {
  try {
    files_.add(state_.progress.step, [&](const std::filesystem::path& path) {
      save_checkpoint(path, state_.model, *state_.optimizer, state_.progress, config_text_,
                      log_->text());
    });
  } catch (const Error& error) {
    throw Error(concat(error.what(), kCheckpointStays));
  }
  saved_step_ = state_.progress.step;
  save_run_model(model_path(output_), state_.model, state_.optimizer.get(), origin());
}

ModelOrigin Trainer::origin() const {
  std::optional<double> val_loss;
  if (summary_.validation) val_loss = summary_.validation->loss;
  return model_origin(config_, config_text_, data_, state_.progress.step, val_loss);
}

}  // namespace lte::train
