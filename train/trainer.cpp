#include "train/trainer.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include <ATen/ops/tensor.h>
#include <torch/types.h>
#include <torch/utils.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/nn/checkpoint.h"
#include "train/interrupt.h"
#include "train/schedule.h"

namespace lte::train {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

}  // namespace

Trainer::Trainer(const TrainConfig& config, std::string config_text, at::Device device,
                 bool resume_run, ProcessGroup* group)
    : config_(config),
      config_text_(std::move(config_text)),
      device_(device),
      group_(group),
      output_(config.output),
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
  log_ = std::make_unique<RunLog>(output_ / "log.jsonl", progress_.step);
  if (config_.train.tensorboard) log_->add_events(output_ / "tensorboard", progress_.step);
  write_file(output_ / "config.yaml", config_text_);
  validation_ = validation_examples(config_, &data_.val);
  if (validation_.empty())
    log_warning(config_.data.root, ": the split \"val\" is empty; the run is not validated");
  if (config_.train.preview_every > 0) previews_ = std::make_unique<Previews>(config_, validation_);
}

void Trainer::start_new() {
  LTE_CHECK(
      !std::filesystem::exists(checkpoint_path(output_)), checkpoint_path(output_).string(),
      ": a run is there already; go on with --resume, or choose another directory with --out");
  std::error_code error;
  if (leads()) std::filesystem::create_directories(output_, error);
  LTE_CHECK(!error, output_.string(), ": cannot create the run directory: ", error.message());
  constexpr double kLeastMean =
      1e-3;  // a split that is all but black must not push the output's bias to −infinity
  if (!config_.has_output_mean)
    config_.model.output_mean = std::max(mean_target(config_, &data_.train), kLeastMean);
  LTE_CHECK(std::isfinite(config_.model.output_mean), config_.data.root,
            ": the mean of the normalized reference is not finite; are there absurd radiances?");
  torch::manual_seed(config_.seed);
  model_ = nn::LightTransportModel(config_.model);
  model_->to(device_);
  optimizer_ = std::make_unique<Optimizer>(config_.train, model_);
  progress_.seed = config_.seed;
  progress_.data_fingerprint = data_.fingerprint;
}

void Trainer::resume() {
  const std::filesystem::path path = checkpoint_path(output_);
  LTE_CHECK(std::filesystem::exists(path), path.string(),
            ": nothing to resume; leave out --resume to start a run");
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
  progress_.data_fingerprint = data_.fingerprint;
  config_.model = header.model;
  model_ = nn::LightTransportModel(config_.model);
  model_->to(device_);
  optimizer_ = std::make_unique<Optimizer>(config_.train, model_);
  load_checkpoint(path, model_, optimizer_.get());
  summary_.step = progress_.step;
  log_info("resumed ", path.string(), " at step ", progress_.step, " of ", config_.train.steps);
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

bool Trainer::told_to_stop() const { return (group_ ? agreed_signal_ : interrupt_signal()) != 0; }

TrainSummary Trainer::run(int64_t stop_after) {
  const InterruptGuard guard;
  const int64_t first = progress_.step, steps = config_.train.steps;
  const int64_t end = stop_after > 0 ? std::min(first + stop_after, steps) : steps;
  if (first >= steps) {
    // The end of an earlier session may have been cut off between the checkpoint and the model
    // made from it.
    log_info(output_.string(), ": all ", steps, " steps were done before");
    if (leads()) save_model_file(model_path(output_));
  } else {
    train_steps(end);
  }
  summary_.step = progress_.step;
  summary_.best_loss = progress_.best_loss;
  summary_.seconds = progress_.seconds;
  if (progress_.step < end) summary_.signal = group_ ? agreed_signal_ : interrupt_signal();
  return summary_;
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
  optimizer_->update(progress_.step, norm);
  progress_.step += 1;
  progress_.window_loss += loss;
  progress_.window_steps += 1;
  progress_.seconds = seconds_before_ + session_timer_.seconds();
  summary_.loss = loss;
  after_step(queries, norm);
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

void Trainer::after_step(int64_t queries, double norm) {
  const int64_t step = progress_.step;
  const bool last = step == config_.train.steps;
  if (!leads()) return;
  window_queries_ += queries;
  if (step % config_.train.log_every == 0 || last) {
    log_->write(step,
                {{"loss", progress_.window_loss / static_cast<double>(progress_.window_steps)},
                 {"lr", learning_rate(config_.train, step - 1)},
                 {"grad_norm", norm},
                 {"queries_per_s", static_cast<double>(window_queries_) / window_timer_.seconds()},
                 {"seconds", progress_.seconds},
                 {"rss_mb", current_rss_mb()}});
    progress_.window_loss = 0;
    progress_.window_steps = window_queries_ = 0;
    window_timer_.restart();
  }
  if (step % config_.train.validate_every == 0 || last) validate_now();
  if (previews_ && (step % config_.train.preview_every == 0 || last)) draw_previews();
  if (step % config_.train.checkpoint_every == 0 || last) save();
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

void Trainer::validate_now() {
  if (validation_.empty()) return;
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
  if (!best) return;
  progress_.best_loss = loss;
  save_model_file(best_model_path(output_));
}

void Trainer::save() {
  saved_step_ = progress_.step;
  save_checkpoint(checkpoint_path(output_), model_, *optimizer_, progress_, config_text_);
  save_model_file(model_path(output_));
}

void Trainer::save_model_file(const std::filesystem::path& path) {
  const AverageScope averaged(optimizer_.get());
  std::map<std::string, std::string> extra = {
      {"config", config_text_},
      {"step", std::to_string(progress_.step)},
      {"scene_points", std::to_string(config_.data.scene_points)},
      {"scene_points_pruned", data_.pruned ? "true" : "false"}};
  if (summary_.validation) extra["val_loss"] = concat(summary_.validation->loss);
  nn::save_model(path, model_, extra);
}

}  // namespace lte::train
