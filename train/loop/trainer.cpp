#include "train/loop/trainer.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include <torch/types.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "train/loop/interrupt.h"
#include "train/optim/schedule.h"

namespace lte::train {
Trainer::Trainer(const TrainConfig& config, std::string config_text, at::Device device,
                 bool resume_run, ProcessGroup* group)
    : config_(config),
      config_text_(std::move(config_text)),
      device_(device),
      group_(group),
      output_(config.output),
      files_(config.output, config.train.keep_checkpoints),
      data_(open_run_data(config)) {
  LTE_CHECK(!config_.output.empty(), "output: names no run directory; give it with --out RUN_DIR");
  const World world = group_ ? group_->world() : World{};
  LTE_CHECK(config_.train.scenes_per_step >= world.size,
            "train.scenes_per_step: ", config_.train.scenes_per_step,
            " scenes cannot be shared out among ", world.size,
            " processes; it counts those of all processes together");
  config_.model.scale = data_.scale;
  resume_run ? resume() : start_new();
  model_->train();
  if (group_) agree_on_start();
  gradients_ = std::make_unique<SceneGradients>(config_, model_, device_, group_);
  loader_ = std::make_unique<BatchLoader>(config_, data_.scale, &data_.train, world);
  seconds_before_ = progress_.seconds;
  if (!leads()) return;
  log_ = std::make_unique<RunLog>(output_ / "log.jsonl", progress_.step, saved_log_);
  saved_log_.reset();
  if (config_.train.tensorboard) log_->add_events(output_ / "tensorboard", progress_.step);
  write_file(output_ / "config.yaml", config_text_);
  validation_ = validation_examples(config_, &data_.val);
  if (validation_.empty())
    log_warning(config_.data.root, ": the split \"val\" is empty; the run is not validated");
  if (config_.train.preview_every > 0) previews_ = std::make_unique<Previews>(config_, validation_);
}

bool Trainer::told_to_stop() const { return (group_ ? agreed_signal_ : interrupt_signal()) != 0; }

TrainSummary Trainer::run(int64_t stop_after) {
  const InterruptGuard guard;
  const int64_t first = progress_.step, steps = config_.train.steps;
  const int64_t end = stop_after > 0 ? std::min(first + stop_after, steps) : steps;
  if (first >= steps) {
    // The end of an earlier session may have been cut off between the checkpoint and the model
    // made from it.
    log_info(output_.string(), ": all ", steps, " steps were done before");
    if (leads()) save_run_model(model_path(output_), model_, optimizer_.get(), origin());
  } else {
    train_steps(end);
  }
  finish();
  summary_.step = progress_.step;
  summary_.best_loss = progress_.best_loss;
  summary_.seconds = progress_.seconds;
  if (progress_.step < end) summary_.signal = group_ ? agreed_signal_ : interrupt_signal();
  return summary_;
}

/// What the session's data were like.
void Trainer::finish() {
  const double session = progress_.seconds - seconds_before_;
  if (session > 0) {
    summary_.wait_share = loader_->waited_seconds() / session;
    if (leads()) log_info("waited for data: ", 100 * summary_.wait_share, " % of the time");
  }
  loader_.reset();  // its thread uses the store
  std::vector<double> met(data_.train.size(), 0.0);
  for (const size_t index : data_.train.bad()) met[index] = 1;
  if (group_ && config_.data.on_bad_scene == "skip") met = group_->sum(met);
  const auto bad = std::count_if(met.begin(), met.end(), [](double times) { return times > 0; });
  summary_.bad_scenes = bad + static_cast<int64_t>(data_.val.bad().size());
  if (leads() && summary_.bad_scenes > 0)
    log_warning(config_.data.root, ": ", bad, " of ", data_.train.size(), " training scenes and ",
                data_.val.bad().size(), " validation scenes could not be used and were skipped");
}

void Trainer::train_steps(int64_t end) {
  lte::Progress line("training", end - progress_.step, "steps");
  session_timer_.restart();
  window_timer_.restart();
  while (progress_.step < end && !told_to_stop()) {
    train_step();
    line.advance();
  }
  if (leads() && saved_step_ != progress_.step) save();
  // Rank 0 keeps the store: it must not leave before the others.
  if (group_) group_->wait_for_all();
}

void Trainer::train_step() {
  if (group_) group_->begin_step(progress_.step + 1);
  const std::vector<Example> examples = loader_->take(progress_.step);
  optimizer_->zero_gradients();
  double loss = gradients_->accumulate(examples, progress_.step + 1);
  int64_t queries = 0;
  for (const Example& example : examples) queries += example.target.size(0);
  if (group_) {
    // A signal to one of the processes ends all of them after the same step.
    const std::vector<double> sums =
        group_->sum({loss, static_cast<double>(queries), interrupt_signal() == SIGINT ? 1.0 : 0.0,
                     interrupt_signal() == SIGTERM ? 1.0 : 0.0});
    loss = sums[0];
    queries = static_cast<int64_t>(sums[1]);
    agreed_signal_ = sums[2] > 0 ? SIGINT : sums[3] > 0 ? SIGTERM : 0;
  }
  const double norm = optimizer_->gradient_norm();
  if (!std::isfinite(norm)) fail_on_gradient(examples);
  // Before the update clips the gradient.
  const NamedValues module_norms =
      leads() && logs_at(progress_.step + 1) ? optimizer_->module_norms() : NamedValues{};
  optimizer_->update(progress_.step, norm);
  progress_.step += 1;
  progress_.window_loss += loss;
  progress_.window_steps += 1;
  progress_.seconds = seconds_before_ + session_timer_.seconds();
  summary_.loss = loss;
  after_step(queries, norm, module_norms);
}

void Trainer::fail_on_gradient(const std::vector<Example>& examples) {
  // Only now is it worth asking which scene it was.
  std::string culprits;
  for (const Example& example : examples) {
    optimizer_->zero_gradients();
    gradients_->accumulate_alone(example, progress_.step + 1);
    if (!std::isfinite(optimizer_->gradient_norm()))
      culprits += (culprits.empty() ? "" : ", ") + example.scene;
  }
  throw Error(concat(
      "step ", progress_.step + 1, ": scene ",
      culprits.empty() ? concat(examples.front().scene, " and its batch mates together") : culprits,
      ": the gradient is not finite; no update was made, the last checkpoint stays"));
}

bool Trainer::logs_at(int64_t step) const {
  return step % config_.train.log_every == 0 || step == config_.train.steps;
}

void Trainer::after_step(int64_t queries, double norm, const NamedValues& module_norms) {
  const int64_t step = progress_.step;
  const bool last = step == config_.train.steps;
  if (!leads()) return;
  window_queries_ += queries;
  if (logs_at(step)) {
    NamedValues fields = {
        {"loss", progress_.window_loss / static_cast<double>(progress_.window_steps)},
        {"lr", learning_rate(config_.train, step - 1)},
        {"grad_norm", norm},
        {"queries_per_s", static_cast<double>(window_queries_) / window_timer_.seconds()},
        {"seconds", progress_.seconds},
        {"wait_share", (loader_->waited_seconds() - waited_before_) / window_timer_.seconds()},
        {"rss_mb", current_rss_mb()}};
    for (const auto& [module, value] : module_norms)
      fields.emplace_back(concat(kModuleNormPrefix, module), value);
    log_->write(step, fields);
    waited_before_ = loader_->waited_seconds();
    progress_.window_loss = 0;
    progress_.window_steps = window_queries_ = 0;
    window_timer_.restart();
  }
  bool best = false;
  if (step % config_.train.validate_every == 0 || last) best = validate_now();
  if (previews_ && (step % config_.train.preview_every == 0 || last)) draw_previews();
  if (step % config_.train.checkpoint_every == 0 || last || best) save();
  if (best) files_.keep_newest_as_best();
}

void Trainer::draw_previews() {
  if (previews_->empty()) return;
  const Timer timer;
  std::vector<PreviewPicture> pictures;
  {
    const AverageScope averaged(optimizer_.get());
    pictures = previews_->draw(model_, device_);
  }
  const int64_t history = config_.train.preview_scenes;
  write_previews(output_, progress_.step, history, pictures);
  for (size_t i = 0; log_->events() && static_cast<int64_t>(i) < history && i < pictures.size();
       ++i) {
    const auto& [scene, width, height, png] = pictures[i];
    log_->events()->image(progress_.step, "preview/" + scene, width, height, png);
  }
  log_->write(progress_.step, {{"preview_seconds", timer.seconds()}});
}

/// @return whether it is the best so far
bool Trainer::validate_now() {
  if (validation_.empty()) return false;
  const Timer timer;
  {
    const AverageScope averaged(optimizer_.get());
    summary_.validation = validate(model_, validation_, config_.loss, device_);
  }
  const double loss = summary_.validation->loss;
  std::vector<std::pair<std::string, double>> fields = summary_.validation->fields();
  fields.emplace_back("val_seconds", timer.seconds());
  log_->write(progress_.step, fields, summary_.validation->scenes);
  const bool best = loss < progress_.best_loss;
  log_info("step ", progress_.step, ": loss ", summary_.loss, ", validation loss ", loss, ", PSNR ",
           summary_.validation->psnr, " dB", best ? ", the best so far" : "");
  if (!best) return false;
  progress_.best_loss = loss;
  progress_.best_step = progress_.step;
  save_run_model(best_model_path(output_), model_, optimizer_.get(), origin());
  return true;
}

void Trainer::save() {
  try {
    files_.add(progress_.step, [&](const std::filesystem::path& path) {
      save_checkpoint(path, model_, *optimizer_, progress_, config_text_, log_->text());
    });
  } catch (const Error& error) {
    throw Error(concat(error.what(), "; the last checkpoint stays, go on from it with --resume"));
  }
  saved_step_ = progress_.step;
  save_run_model(model_path(output_), model_, optimizer_.get(), origin());
}

ModelOrigin Trainer::origin() const {
  ModelOrigin origin{config_text_, progress_.step, config_.data.scene_points, data_.pruned, {}};
  if (summary_.validation) origin.val_loss = summary_.validation->loss;
  return origin;
}

}  // namespace lte::train
