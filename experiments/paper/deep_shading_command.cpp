// experiment_paper deep-shading: trains Deep Shading on the views of a data set for some time, and
// scores it on those of another, or of the same: then it knows them by heart.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/optim/adam.h>
#include <torch/types.h>

#include "bench/begin_command.h"
#include "experiments/paper/commands.h"
#include "experiments/paper/deep_shading.h"
#include "experiments/paper/timed_training.h"
#include "experiments/paper/view_scores.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/numbers.h"

namespace lte::experiments {
namespace {

constexpr int64_t kViewsPerStep = 4;

struct Request {
  std::string data, split = "train", test;
  TimedTraining training;
  uint64_t seed = 1;
  CommonOptions common;
};

std::vector<ShadingView> views_of(const std::vector<EvalScene>& scenes) {
  std::vector<ShadingView> out;
  for (const EvalScene& scene : scenes) {
    for (const data::View& view : scene.sample.views)
      out.push_back(shading_view(view, scene.sample.light_groups, scene.radiance));
  }
  return out;
}

void run(const Request& request) {
  CommandFiles files;
  bench::begin_command(request.common, &files);
  torch::manual_seed(request.seed);
  const std::vector<ShadingView> views =
      views_of(read_eval_scenes(request.data, data::parse_split(request.split)));
  LTE_CHECK(!views.empty(), request.data, ": scenes of split ", request.split,
            " have no views; generate it with evaluation_splits: [", request.split, "]");
  const std::vector<EvalScene> test = read_eval_scenes(request.test, data::Split::Test);
  DeepShading network;
  torch::optim::Adam optimizer(network->parameters(), torch::optim::AdamOptions());
  const auto count = static_cast<int64_t>(views.size());
  double loss = 0;
  const int64_t steps = train_for(request.training, optimizer, [&] {
    at::Tensor sum = at::zeros({});
    for (int64_t i = 0; i < kViewsPerStep; ++i) {
      const auto pick = static_cast<size_t>(at::randint(count, {1}).item<int64_t>());
      sum = sum + shading_loss(*network, views[pick]) / static_cast<double>(kViewsPerStep);
    }
    loss = sum.item<double>();
    return sum;
  });
  int64_t parameters = 0;
  for (const at::Tensor& parameter : network->parameters()) parameters += parameter.numel();
  nlohmann::json json = score_views(
      test, [&](const EvalScene& scene, const data::View& view, const infer::ViewPixels&) {
        return shade(*network, shading_view(view, scene.sample.light_groups, scene.radiance));
      });
  std::printf("deep shading: %lld steps, MSE %.4g, SSIM %.3f\n", static_cast<long long>(steps),
              json["mse"].get<double>(), json["ssim"].get<double>());
  if (request.common.json.empty()) return;
  json.update({{"parameters", parameters},
               {"views", views.size()},
               {"steps", steps},
               {"seconds", request.training.seconds},
               {"seed", request.seed},
               {"loss", loss}});
  write_file(request.common.json, json.dump(1) + "\n");
}

}  // namespace

std::function<void()> add_deep_shading(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  CLI::App* command = app->add_subcommand(
      "deep-shading", "Train Deep Shading on views, and score it on those of a test split");
  command->add_option("--data", request->data, "Data set whose views are learnt")->required();
  command->add_option("--split", request->split, "Its split: train, val or test")
      ->check(CLI::IsMember({"train", "val", "test"}))
      ->capture_default_str();
  command->add_option("--test", request->test, "Data set whose test split is scored")->required();
  command->add_option("--seconds", request->training.seconds, "Processor time of training")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--seed", request->seed, "Of weights and batches")->capture_default_str();
  add_common_options(*command, &request->common);
  return [request] { run(*request); };
}

}  // namespace lte::experiments
