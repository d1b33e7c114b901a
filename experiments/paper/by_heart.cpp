// experiment_paper by-heart: what learns one scene best in equal time, a hash grid or latents at
// scene points.
#include "train/fit/by_heart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/types.h>

#include "experiments/paper/by_heart_models.h"
#include "experiments/paper/commands.h"
#include "experiments/paper/trial.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/nn/cost.h"
#include "lte/nn/model_parts.h"
#include "lte/ops/farthest_point.h"
#include "train/data/example.h"

namespace lte::experiments {
namespace {

constexpr double kScale = 16;          // s, metres
constexpr int64_t kHeldOutEvery = 10;  // of the queries
constexpr int kLooks = 8;              // at the held-out error in the course of the time
constexpr int64_t kBlock = 16'384;     // queries that are measured at a time
constexpr double kGridRate = 1e-2, kLatentRate = 3e-3;

struct ByHeartTrial : Trial {
  std::string sample, method = "grid";
  int64_t batch = 4096, log2_entries = 15, queries = 0;
};

/// The scene's queries in the two parts that are learnt and held out, and where latents may lie.
struct Task {
  at::Tensor attributes, target;  ///< [Q, 9], [Q, 3]
  nn::Surface query, anchor;
  at::Tensor learnt, held_out;  ///< rows of the queries
  double spacing = 1, extent = 1, output_mean = 1;
};

Task make_task(const ByHeartTrial& request) {
  const train::TrainingScene scene = train::read_training_scene(request.sample, request.sample);
  LTE_CHECK(scene.query_points() >= 2 * kHeldOutEvery, request.sample, ": has ",
            scene.query_points(), " query points; expected at least ", 2 * kHeldOutEvery);
  Rng rng(request.seed);
  const train::Example example = train::make_example(
      scene, train::identity_symmetry(scene.light_groups), /*scene_points=*/0, /*queries=*/0, &rng);
  const at::Tensor origin = std::get<0>(example.points.position.min(0));
  const at::Tensor points = (example.points.position - origin).div(kScale).contiguous();
  const auto [picks, distance] =
      ops::farthest_point_sampling(points, nn::latent_count(points.size(0)));
  Task task;
  task.query = {(example.queries.position - origin).div(kScale), example.queries.normal};
  task.attributes =
      nn::surface_attributes(task.query.position, task.query.normal, example.queries.albedo);
  task.anchor = {points.index_select(0, picks), example.points.normal.index_select(0, picks)};
  task.spacing = std::sqrt(std::max(distance[-1].item<double>(), 1e-12));
  task.extent = std::max(points.max().item<double>(), 1e-6);
  const at::Tensor row = at::arange(example.target.size(0));
  task.held_out = at::nonzero(row % kHeldOutEvery == 0).squeeze(1);
  task.learnt = at::nonzero(row % kHeldOutEvery != 0).squeeze(1);
  if (request.queries > 0)
    task.learnt = task.learnt.narrow(0, 0, std::min(request.queries, task.learnt.size(0)));
  const double mean = example.target.mean().item<double>();
  LTE_CHECK(mean > 0, request.sample, ": no indirect light reaches its query points");
  task.target = example.target.div(mean);
  return task;
}

std::shared_ptr<ByHeartImpl> make_network(const ByHeartTrial& request, const Task& task) {
  if (request.method == "grid") {
    HashGridConfig config;
    config.log2_entries = request.log2_entries;
    return std::make_shared<GridByHeart>(config, task.extent, task.output_mean);
  }
  nn::ModelConfig config = nn::ModelConfig::of(nn::Preset::Lte);
  config.channels = 32;
  config.dropout = 0;
  config.light_input = nn::LightInput::Emission;
  return std::make_shared<LatentsByHeart>(
      request.method == "latents-mean" ? LatentReader::Mean : LatentReader::Decoder, task.anchor,
      task.spacing, config);
}

at::Tensor answer(ByHeartImpl& network, const Task& task, const at::Tensor& rows) {
  return network.forward(
      task.attributes.index_select(0, rows),
      {task.query.position.index_select(0, rows), task.query.normal.index_select(0, rows)});
}

/// Mean squared error over the mean square of the target.
double relative_error(ByHeartImpl& network, const Task& task, const at::Tensor& rows) {
  double error = 0, square = 0;
  const at::NoGradGuard no_grad;
  for (const at::Tensor& block : rows.split(kBlock)) {
    const at::Tensor target = task.target.index_select(0, block);
    error += (answer(network, task, block) - target).square().sum().item<double>();
    square += target.square().sum().item<double>();
  }
  return error / square;
}

nlohmann::json learn(ByHeartImpl& network, const Task& task, const ByHeartTrial& request) {
  nlohmann::json looks = nlohmann::json::array();
  train::ByHeartLimits limits;
  limits.seconds = request.seconds;
  limits.clock = processor_seconds;
  limits.rate = request.method == "grid" ? kGridRate : kLatentRate;
  limits.batch = request.batch;
  const auto look = [&](int64_t steps, double used) {
    const double due =
        request.seconds * static_cast<double>(looks.size() + 1) / static_cast<double>(kLooks);
    if (used < due) return true;
    const double error = relative_error(network, task, task.held_out);
    LTE_CHECK(std::isfinite(error), "step ", steps, ": the error is not finite");
    looks.push_back({{"seconds", used}, {"steps", steps}, {"held_out_relmse", error}});
    return true;
  };
  train::learn_by_heart(
      {network.parameters(), [&](const at::Tensor& rows) { return answer(network, task, rows); },
       task.target, task.learnt},
      limits, look);
  return looks;
}

void run(const ByHeartTrial& request) {
  begin_trial(request, request.sample);
  const Task task = make_task(request);
  const std::shared_ptr<ByHeartImpl> network = make_network(request, task);
  const double first = relative_error(*network, task, task.held_out);
  const nlohmann::json looks = learn(*network, task, request);
  const int64_t every =
      std::max<int64_t>(1, task.learnt.size(0) / std::max<int64_t>(1, task.held_out.size(0)));
  const at::Tensor seen = task.learnt.slice(0, 0, task.learnt.size(0), every);
  nlohmann::json json = {{"method", request.method},
                         {"log2_entries", request.log2_entries},
                         {"learnt_queries", task.learnt.size(0)},
                         {"held_out_queries", task.held_out.size(0)},
                         {"latents", task.anchor.position.size(0)},
                         {"parameters", trained_parameters(*network)},
                         {"first_relmse", first},
                         {"looks", looks},
                         {"learnt_relmse", relative_error(*network, task, seen)}};
  std::printf("%s: relative error %.4g at first, %.4g held out\n", request.method.c_str(), first,
              looks.back()["held_out_relmse"].get<double>());
  write_report(request, std::move(json));
}

void add_flags(CLI::App& command, ByHeartTrial* request) {
  command.add_option("SAMPLE", request->sample, "Sample file of lte_datagen bake")->required();
  add_choice(command, "--method", &request->method, {"grid", "latents-mean", "latents-decoder"},
             "What learns");
  add_seconds_option(command, request);
  add_count(command, "--batch", &request->batch, 1, "Queries of a step");
  add_count(command, "--queries", &request->queries, 0, "Queries that are learnt; 0: nine in ten");
  command.add_option("--log2-entries", request->log2_entries, "Of a level of the grid")
      ->check(CLI::Range(4, 24))
      ->capture_default_str();
}

}  // namespace

std::function<void()> add_by_heart(CLI::App* app) {
  return add_trial<ByHeartTrial>(
      app, "by-heart", "Learn the irradiance of one scene, and measure it where it was not shown",
      add_flags, run);
}

}  // namespace lte::experiments
