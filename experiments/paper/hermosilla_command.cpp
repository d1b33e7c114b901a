// experiment_paper hermosilla: trains the point network for some time on the scenes of a data set,
// and scores it on the views of another, as trained and after some steps on each scene's points.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/optim/adam.h>
#include <torch/types.h>

#include "experiments/paper/commands.h"
#include "experiments/paper/point_network.h"
#include "experiments/paper/timed_training.h"
#include "experiments/paper/trial.h"
#include "experiments/paper/view_scores.h"
#include "lte/cli/numbers.h"
#include "lte/nn/loss.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"

namespace lte::experiments {
namespace {

constexpr double kTunedRate = 0.3;  // of the rate of training

struct HermosillaTrial : Trial {
  double tuned_seconds = 0;  ///< on each scene that is scored
};

/// A scene that is scored, as the network reads it, and what is known there to be tuned on.
struct TestScene {
  train::Example example;
  PointLevels levels;
};

TestScene test_scene(const EvalScene& scene, const train::TrainConfig& config) {
  const train::TrainingScene read =
      train::read_training_scene(scene.path, scene.sample.name, nn::LightInput::Traced);
  Rng rng(config.seed);
  train::Example example = train::make_example(read, train::identity_symmetry(read.light_groups),
                                               config.data.scene_points, /*queries=*/0, &rng);
  PointLevels levels = point_levels(example.points);
  return {std::move(example), std::move(levels)};
}

nn::QuerySet queries_of(const infer::ViewPixels& pixels) {
  const auto tensor = [](const std::vector<Vec3>& values) {
    at::Tensor out = at::empty({static_cast<int64_t>(values.size()), 3}, at::kFloat);
    std::copy(values.begin(), values.end(), reinterpret_cast<Vec3*>(out.data_ptr<float>()));
    return out;
  };
  return {tensor(pixels.position), tensor(pixels.normal), tensor(pixels.albedo)};
}

std::vector<Rgb> answer(PointNetwork& network, const TestScene& scene, const EvalScene& eval,
                        const infer::ViewPixels& pixels) {
  const at::NoGradGuard no_grad;
  const at::Tensor light = network->forward(scene.levels, queries_of(pixels))
                               .mul(scene.levels.scale.to(at::kFloat) / eval.radiance)
                               .contiguous();
  const auto* values = reinterpret_cast<const Rgb*>(light.const_data_ptr<float>());
  return {values, values + light.size(0)};
}

class Training {
 public:
  Training(const HermosillaTrial& request, const train::TrainConfig& config)
      : request_(request),
        config_(config),
        data_(train::open_run_data(config)),
        network_(train::mean_target(config, &data_.train)) {}

  int64_t train() {
    torch::optim::Adam optimizer(network_->parameters(), torch::optim::AdamOptions());
    train::BatchLoader loader(config_, data_.scale, &data_.train);
    int64_t step = 0;
    return train_for({request_.seconds}, optimizer, [&] {
      at::Tensor sum = at::zeros({});
      const std::vector<train::Example> examples = loader.take(step++);
      for (const train::Example& example : examples)
        sum = sum +
              loss_of(example, point_levels(example.points)) / static_cast<double>(examples.size());
      loss_ = sum.item<double>();
      return sum;
    });
  }

  /// Scores the network on views; with `tuned_seconds`, after so long on each scene's query points.
  nlohmann::json score(const std::vector<EvalScene>& test, double tuned_seconds) {
    std::map<std::string, TestScene> known;
    const std::vector<at::Tensor> trained = copies();
    nlohmann::json out = score_views(
        test, [&](const EvalScene& scene, const data::View&, const infer::ViewPixels& pixels) {
          auto found = known.find(scene.sample.name);
          if (found == known.end()) {
            found = known.emplace(scene.sample.name, test_scene(scene, config_)).first;
            if (tuned_seconds > 0) tune(found->second, trained, tuned_seconds);
          }
          return answer(network_, found->second, scene, pixels);
        });
    restore(trained);
    return out;
  }

  double loss() const { return loss_; }
  int64_t scenes() const { return static_cast<int64_t>(data_.train.size()); }
  int64_t parameters() const { return trained_parameters(*network_); }

 private:
  at::Tensor loss_of(const train::Example& example, const PointLevels& levels) {
    return nn::relative_loss(network_->forward(levels, example.queries), example.target,
                             config_.loss);
  }

  std::vector<at::Tensor> copies() const {
    std::vector<at::Tensor> out;
    for (const at::Tensor& parameter : network_->parameters())
      out.push_back(parameter.detach().clone());
    return out;
  }

  void restore(const std::vector<at::Tensor>& weights) {
    const at::NoGradGuard no_grad;
    std::vector<at::Tensor> parameters = network_->parameters();
    for (size_t i = 0; i < parameters.size(); ++i) parameters[i].copy_(weights[i]);
  }

  void tune(const TestScene& scene, const std::vector<at::Tensor>& from, double seconds) {
    restore(from);
    torch::optim::Adam optimizer(network_->parameters(), torch::optim::AdamOptions());
    train_for({seconds, kTunedRate * TimedTraining().rate}, optimizer,
              [&] { return loss_of(scene.example, scene.levels); });
  }

  const HermosillaTrial& request_;
  const train::TrainConfig& config_;
  train::RunData data_;
  PointNetwork network_;
  double loss_ = 0;
};

void run(const HermosillaTrial& request) {
  begin_trial(request);
  // Direct light on scene points is read.
  const train::TrainConfig config = training_config(request, {"model.light_input=traced"});
  const std::vector<std::vector<EvalScene>> tests = read_tests(request.test, request.also);
  Training training(request, config);
  const int64_t steps = training.train();
  nlohmann::json json = score_tests(tests, [&](const std::vector<EvalScene>& scenes) {
    nlohmann::json out = training.score(scenes, 0);
    if (request.tuned_seconds > 0) out["tuned"] = training.score(scenes, request.tuned_seconds);
    return out;
  });
  std::printf("hermosilla: %lld steps, MSE %.4g, SSIM %.3f\n", static_cast<long long>(steps),
              json["mse"].get<double>(), json["ssim"].get<double>());
  json.update({{"parameters", training.parameters()},
               {"training_scenes", training.scenes()},
               {"steps", steps},
               {"seconds", request.seconds},
               {"tuned_seconds", request.tuned_seconds},
               {"loss", training.loss()}});
  write_report(request, std::move(json));
}

void add_flags(CLI::App& command, HermosillaTrial* request) {
  add_config_options(command, request);
  add_data_option(command, request, "Data set with direct light on scene points");
  add_test_option(command, request);
  add_seconds_option(command, request);
  command
      .add_option("--tuned-seconds", request->tuned_seconds,
                  "Processor time on the query points of each test scene, for a second score")
      ->check(non_negative_number())
      ->capture_default_str();
}

}  // namespace

std::function<void()> add_hermosilla(CLI::App* app) {
  return add_trial<HermosillaTrial>(
      app, "hermosilla", "Train the point network of Hermosilla et al., as the paper improved it",
      add_flags, run);
}

}  // namespace lte::experiments
