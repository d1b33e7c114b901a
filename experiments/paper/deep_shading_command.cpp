// experiment_paper deep-shading: trains Deep Shading on the views of a data set for some time, and
// scores it on those of another, or of the same: then it knows them by heart.
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/optim/adam.h>
#include <torch/types.h>

#include "experiments/paper/commands.h"
#include "experiments/paper/deep_shading.h"
#include "experiments/paper/timed_training.h"
#include "experiments/paper/trial.h"
#include "experiments/paper/view_scores.h"
#include "lte/base/check.h"

namespace lte::experiments {
namespace {

constexpr int64_t kPixelsPerStep = 7000;  // of several small views, or of one

struct DeepShadingTrial : Trial {
  std::string split = "train";
};

std::vector<ShadingView> views_of(const std::vector<EvalScene>& scenes,
                                  const image::Denoiser& denoiser) {
  std::vector<ShadingView> out;
  for (const EvalScene& scene : scenes) {
    for (const data::View& view : scene.sample.views)
      out.push_back(shading_view(view, scene.sample.light_groups, scene.radiance, denoiser));
  }
  return out;
}

void run(const DeepShadingTrial& request) {
  begin_trial(request);
  const image::Denoiser denoiser;
  const std::vector<ShadingView> views =
      views_of(read_eval_scenes(request.data, data::parse_split(request.split)), denoiser);
  LTE_CHECK(!views.empty(), request.data, ": scenes of split ", request.split,
            " have no views; generate it with evaluation_splits: [", request.split, "]");
  const std::vector<std::vector<EvalScene>> tests = read_tests(request.test, request.also);
  DeepShading network;
  torch::optim::Adam optimizer(network->parameters(), torch::optim::AdamOptions());
  const auto count = static_cast<int64_t>(views.size());
  const int64_t views_per_step = std::max<int64_t>(1, kPixelsPerStep / views.front().mask.numel());
  double loss = 0;
  const int64_t steps = train_for({request.seconds}, optimizer, [&] {
    at::Tensor sum = at::zeros({});
    for (int64_t i = 0; i < views_per_step; ++i) {
      const auto pick = static_cast<size_t>(at::randint(count, {1}).item<int64_t>());
      sum = sum + shading_loss(*network, views[pick]) / static_cast<double>(views_per_step);
    }
    loss = sum.item<double>();
    return sum;
  });
  const auto answer = [&](const EvalScene& scene, const data::View& view,
                          const infer::ViewPixels&) {
    return shade(*network, shading_view(view, scene.sample.light_groups, scene.radiance, denoiser));
  };
  nlohmann::json json = score_tests(
      tests, [&](const std::vector<EvalScene>& scenes) { return score_views(scenes, answer); });
  std::printf("deep shading: %lld steps, MSE %.4g, SSIM %.3f\n", static_cast<long long>(steps),
              json["mse"].get<double>(), json["ssim"].get<double>());
  json.update({{"parameters", trained_parameters(*network)},
               {"views", views.size()},
               {"steps", steps},
               {"seconds", request.seconds},
               {"loss", loss}});
  write_report(request, std::move(json));
}

void add_flags(CLI::App& command, DeepShadingTrial* request) {
  add_data_option(command, request, "Data set whose views are learnt");
  add_choice(command, "--split", &request->split, {"train", "val", "test"}, "Its split");
  add_test_option(command, request);
  add_seconds_option(command, request);
}

}  // namespace

std::function<void()> add_deep_shading(CLI::App* app) {
  return add_trial<DeepShadingTrial>(
      app, "deep-shading", "Train Deep Shading on views, and score it on those of a test split",
      add_flags, run);
}

}  // namespace lte::experiments
