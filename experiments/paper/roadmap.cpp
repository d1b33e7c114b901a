// experiment_paper roadmap: trains one network of the paper's roadmap for a number of steps by
// AdamW, without an average of the weights, and measures it on the validation split on the way, and
// once on the test split, if there is one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>

#include "experiments/paper/commands.h"
#include "experiments/paper/roadmap_model.h"
#include "experiments/paper/trial.h"
#include "lte/base/check.h"
#include "lte/base/process_memory.h"
#include "lte/data/dataset.h"
#include "lte/nn/loss.h"
#include "train/config.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/optim/schedule.h"

namespace lte::experiments {
namespace {

struct RoadmapTrial : Trial {
  std::string network = "whole";
  int64_t steps = 400, looks = 1, scenes = 0;
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

train::TrainConfig configuration(const RoadmapTrial& request) {
  train::TrainConfig config = training_config(request, {concat("train.steps=", request.steps)});
  LTE_CHECK(!config.model.reads_light() && !config.model.predicts_radiance(),
            "model.light_input: the roadmap's networks read emission alone");
  LTE_CHECK(config.train.optimizer == train::OptimizerKind::AdamW,
            "train.optimizer: the roadmap's networks are trained by adamw");
  return config;
}

struct Errors {
  double loss = 0, mse = 0;
  double share = 0;  ///< MSE over the mean square of a scene's targets
};

/// Means over scenes, of irradiance over the emission scale.
Errors validate(RoadmapModel& model, const std::vector<train::Example>& examples,
                const nn::LossConfig& loss) {
  const at::NoGradGuard no_grad;
  model->eval();
  Errors sum;
  for (const train::Example& example : examples) {
    const at::Tensor answer =
        model->forward({example.points}, {example.queries}, {example.seed})[0];
    const double mse = (answer - example.target).square().mean().item<double>();
    sum.loss += nn::relative_loss(answer, example.target, loss).item<double>();
    sum.mse += mse;
    sum.share += mse / std::max(1e-12, example.target.square().mean().item<double>());
  }
  model->train();
  const auto count = static_cast<double>(examples.size());
  return {sum.loss / count, sum.mse / count, sum.share / count};
}

/// The first scenes of a split; 0: all.
train::SceneStore store_of(const train::TrainConfig& config, double scale, data::Split split,
                           int64_t scenes) {
  const std::filesystem::path root = config.data.root;
  std::vector<data::DatasetEntry> entries = data::entries_of(data::read_dataset_info(root), split);
  if (scenes > 0) entries.resize(std::min(entries.size(), static_cast<size_t>(scenes)));
  return {root,
          std::move(entries),
          {.cache_bytes = static_cast<size_t>(config.data.cache_mb) << 20,
           .scale = scale,
           .light = train::LightKeys(config.model)}};
}

nlohmann::json to_json(const Errors& errors) {
  return {{"loss", errors.loss}, {"mse", errors.mse}, {"share", errors.share}};
}

/// The update of one step, of the mean loss over its scenes.
double train_step(RoadmapModel& model, const std::vector<train::Example>& examples,
                  const train::TrainConfig& config, int64_t step, torch::optim::AdamW* optimizer) {
  std::vector<nn::PointSet> points;
  std::vector<nn::QuerySet> queries;
  std::vector<uint64_t> seeds;
  for (const train::Example& example : examples) {
    points.push_back(example.points);
    queries.push_back(example.queries);
    seeds.push_back(example.seed);
  }
  optimizer->zero_grad();
  const std::vector<at::Tensor> answers = model->forward(points, queries, seeds);
  at::Tensor sum = at::zeros({});
  for (size_t i = 0; i < answers.size(); ++i)
    sum = sum + nn::relative_loss(answers[i], examples[i].target, config.loss);
  const at::Tensor loss = sum / static_cast<double>(examples.size());
  loss.backward();
  torch::nn::utils::clip_grad_norm_(model->parameters(), config.train.clip_norm);
  for (auto& group : optimizer->param_groups())
    group.options().set_lr(train::learning_rate(config.train, step));
  optimizer->step();
  return loss.item<double>();
}

void run(const RoadmapTrial& request) {
  begin_trial(request);
  train::TrainConfig config = configuration(request);
  train::RunData data = train::open_run_data(config);
  config.model.scale = data.scale;
  if (request.scenes > 0)
    data.train = store_of(config, data.scale, data::Split::Train, request.scenes);
  config.model.output_mean = train::mean_target(config, &data.train);
  const std::vector<train::Example> held_out = train::validation_examples(config, &data.val);
  LTE_CHECK(!held_out.empty(), request.data, ": the validation split is empty");
  LTE_CHECK(config.data.scene_points > 0,
            "data.scene_points: 0 stands for all there are, but the "
            "roadmap's networks read as many of each scene");
  RoadmapModel model(parse_enum<RoadmapNetwork>("--network", request.network), config.model);
  model->train();
  torch::optim::AdamW optimizer(model->parameters(),
                                torch::optim::AdamWOptions(config.train.learning_rate)
                                    .weight_decay(config.train.weight_decay)
                                    .eps(config.train.adam_epsilon));
  const Errors first = validate(model, held_out, config.loss);
  train::BatchLoader loader(config, data.scale, &data.train);
  double loss = 0, seconds = 0;
  Errors last;
  nlohmann::json looks = nlohmann::json::array();
  for (int64_t step = 1; step <= config.train.steps; ++step) {
    const double begin = cpu_seconds();
    loss = train_step(model, loader.take(step - 1), config, step - 1, &optimizer);
    LTE_CHECK(std::isfinite(loss), "step ", step, ": the loss is not finite");
    seconds += cpu_seconds() - begin;
    const auto due = static_cast<int64_t>(looks.size()) + 1;
    if (step * request.looks < due * config.train.steps) continue;
    last = validate(model, held_out, config.loss);
    looks.push_back(to_json(last));
    looks.back().update({{"step", step}, {"cpu_seconds", seconds}});
  }
  train::SceneStore test_scenes = store_of(config, data.scale, data::Split::Test, 0);
  const std::vector<train::Example> test = train::validation_examples(config, &test_scenes);
  std::printf("%s, seed %llu: error %.4g at first, %.4g after %lld steps of %.0f ms\n",
              request.network.c_str(), static_cast<unsigned long long>(request.seed), first.share,
              last.share, static_cast<long long>(request.steps),
              1e3 * seconds / static_cast<double>(request.steps));
  nlohmann::json json = {{"network", request.network},
                         {"steps", request.steps},
                         {"scenes", data.train.size()},
                         {"held_out_scenes", held_out.size()},
                         {"parameters", trained_parameters(*model)},
                         {"train_loss", loss},
                         {"first_loss", first.loss},
                         {"first_mse", first.mse},
                         {"loss", last.loss},
                         {"mse", last.mse},
                         {"first_share", first.share},
                         {"share", last.share},
                         {"looks", looks},
                         {"cpu_seconds", seconds},
                         {"peak_rss_mb", peak_rss_mb()}};
  if (!test.empty()) {
    json["test"] = to_json(validate(model, test, config.loss));
    json["test"]["scenes"] = test.size();
  }
  write_report(request, std::move(json));
}

void add_flags(CLI::App& command, RoadmapTrial* request) {
  add_choice(command, "--network", &request->network, {"vanilla", "encoder", "whole"},
             "Row of the roadmap");
  add_config_options(command, request);
  add_data_option(command, request, "Data set with a validation split");
  add_count(command, "--steps", &request->steps, 1, "Training steps");
  add_count(command, "--scenes", &request->scenes, 0, "Of the training split, the first; 0: all");
  add_count(command, "--looks", &request->looks, 1,
            "At the validation split in the course of them");
}

}  // namespace

std::function<void()> add_roadmap(CLI::App* app) {
  return add_trial<RoadmapTrial>(
      app, "roadmap", "Train one network of the paper's roadmap and measure it on held-out scenes",
      add_flags, run);
}

}  // namespace lte::experiments
