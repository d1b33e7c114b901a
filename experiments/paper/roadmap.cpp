// experiment_paper roadmap: trains one network of the paper's roadmap for a number of steps, and
// measures it on the validation split.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>
#include <torch/utils.h>

#include "bench/begin_command.h"
#include "experiments/paper/commands.h"
#include "experiments/paper/roadmap_model.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/base/process_memory.h"
#include "lte/cli/numbers.h"
#include "lte/nn/loss.h"
#include "train/config.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/optim/schedule.h"

namespace lte::experiments {
namespace {

struct Request {
  std::string network = "whole", config, data;
  std::vector<std::string> overrides;
  int64_t steps = 400;
  uint64_t seed = 1;
  CommonOptions common;
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

train::TrainConfig configuration(const Request& request) {
  std::vector<std::string> overrides = request.overrides;
  overrides.push_back("data.root=" + nlohmann::json(request.data).dump());
  overrides.push_back(concat("train.steps=", request.steps));
  overrides.push_back(concat("seed=", request.seed));
  train::TrainConfig config = train::TrainConfig::read(Config::load(request.config, overrides));
  LTE_CHECK(!config.model.reads_light() && !config.model.predicts_radiance(),
            "model.light_input: the roadmap's networks read emission alone");
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
    const at::Tensor answer = model->forward(example.points, example.queries, example.seed);
    const double mse = (answer - example.target).square().mean().item<double>();
    sum.loss += nn::relative_loss(answer, example.target, loss).item<double>();
    sum.mse += mse;
    sum.share += mse / std::max(1e-12, example.target.square().mean().item<double>());
  }
  model->train();
  const auto count = static_cast<double>(examples.size());
  return {sum.loss / count, sum.mse / count, sum.share / count};
}

int64_t trained_parameters(const RoadmapModel& model) {
  int64_t count = 0;
  for (const at::Tensor& parameter : model->parameters())
    count += parameter.requires_grad() ? parameter.numel() : 0;
  return count;
}

/// The update of one step, of the mean loss over its scenes.
double train_step(RoadmapModel& model, const std::vector<train::Example>& examples,
                  const train::TrainConfig& config, int64_t step, torch::optim::AdamW* optimizer) {
  optimizer->zero_grad();
  double sum = 0;
  for (const train::Example& example : examples) {
    const at::Tensor answer = model->forward(example.points, example.queries, example.seed);
    const at::Tensor loss = nn::relative_loss(answer, example.target, config.loss);
    loss.div(static_cast<double>(examples.size())).backward();
    sum += loss.item<double>();
  }
  torch::nn::utils::clip_grad_norm_(model->parameters(), config.train.clip_norm);
  for (auto& group : optimizer->param_groups())
    group.options().set_lr(train::learning_rate(config.train, step));
  optimizer->step();
  return sum / static_cast<double>(examples.size());
}

void run(const Request& request) {
  CommandFiles files;
  files.reads("--config", request.config);
  bench::begin_command(request.common, &files);
  train::TrainConfig config = configuration(request);
  train::RunData data = train::open_run_data(config);
  config.model.scale = data.scale;
  config.model.output_mean = train::mean_target(config, &data.train);
  const std::vector<train::Example> held_out = train::validation_examples(config, &data.val);
  LTE_CHECK(!held_out.empty(), request.data, ": the validation split is empty");
  torch::manual_seed(request.seed);
  RoadmapModel model(parse_enum<RoadmapNetwork>("--network", request.network), config.model);
  model->train();
  torch::optim::AdamW optimizer(model->parameters(),
                                torch::optim::AdamWOptions(config.train.learning_rate)
                                    .weight_decay(config.train.weight_decay)
                                    .eps(config.train.adam_epsilon));
  const Errors first = validate(model, held_out, config.loss);
  train::BatchLoader loader(config, data.scale, &data.train);
  double loss = 0;
  const double begin = cpu_seconds();
  for (int64_t step = 0; step < config.train.steps; ++step) {
    loss = train_step(model, loader.take(step), config, step, &optimizer);
    LTE_CHECK(std::isfinite(loss), "step ", step + 1, ": the loss is not finite");
  }
  const double seconds = cpu_seconds() - begin;
  const Errors last = validate(model, held_out, config.loss);
  std::printf("%s, seed %llu: error %.4g at first, %.4g after %lld steps of %.0f ms\n",
              request.network.c_str(), static_cast<unsigned long long>(request.seed), first.share,
              last.share, static_cast<long long>(request.steps),
              1e3 * seconds / static_cast<double>(request.steps));
  if (request.common.json.empty()) return;
  const nlohmann::json json = {{"network", request.network},
                               {"seed", request.seed},
                               {"steps", request.steps},
                               {"scenes", data.train.size()},
                               {"held_out_scenes", held_out.size()},
                               {"parameters", trained_parameters(model)},
                               {"train_loss", loss},
                               {"first_loss", first.loss},
                               {"first_mse", first.mse},
                               {"loss", last.loss},
                               {"mse", last.mse},
                               {"first_share", first.share},
                               {"share", last.share},
                               {"cpu_seconds", seconds},
                               {"peak_rss_mb", peak_rss_mb()}};
  write_file(request.common.json, json.dump(1) + "\n");
}

}  // namespace

std::function<void()> add_roadmap(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  CLI::App* command = app->add_subcommand(
      "roadmap", "Train one network of the paper's roadmap and measure it on held-out scenes");
  command->add_option("--network", request->network, "vanilla, encoder or whole")
      ->check(CLI::IsMember({"vanilla", "encoder", "whole"}))
      ->capture_default_str();
  command->add_option("--config", request->config, "Training configuration (.yaml)")->required();
  command->add_option("--data", request->data, "Data set with a validation split")->required();
  command->add_option("--set", request->overrides, "Override a key: key=value")->take_all();
  command->add_option("--steps", request->steps, "Training steps")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--seed", request->seed, "Of weights and examples")->capture_default_str();
  add_common_options(*command, &request->common);
  return [request] { run(*request); };
}

}  // namespace lte::experiments
