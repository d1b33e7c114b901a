#include "train/loop/model_health.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/base/text.h"
#include "train/checkpoint/checkpoint.h"
#include "train/checkpoint/init_weights.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/loop/scene_gradients.h"
#include "train/loop/validate.h"
#include "train/optim/optimizer.h"
#include "train/optim/weight_movement.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

/// The configuration that a model file or a checkpoint was trained with, on the data of `options`.
TrainConfig config_of(const HealthOptions& options) {
  const SafetensorsFile file(options.model);
  const Config yaml =
      Config::parse(file.metadata("config"), concat(options.model, ": metadata config"));
  TrainConfig config = TrainConfig::read(yaml);
  config.model = nn::ModelConfig::read(
      Config::parse(file.metadata("model_config"), concat(options.model, ": model_config")));
  config.data.root = options.data;
  config.train.validation_scenes = options.scenes;
  config.train.validation_queries = config.data.queries_per_scene;
  config.train.scenes_per_step = 1;
  config.train.autocast = nn::Precision::Fp32;
  config.has_scale = false;
  return config;
}

nn::LightTransportModel model_of(const HealthOptions& options, const TrainConfig& config,
                                 const std::string& file, const RunData& data) {
  nn::LightTransportModel model(config.model);
  init_weights(file, {}, model, data.light);
  model->train();
  LTE_CHECK(config.model.scale == data.scale, options.data, ": its scale is ", data.scale,
            " m, but that of ", file, " is ", config.model.scale, " m");
  return model;
}

/// Adds `stages` of one scene to the sums over scenes.
void add_stages(const std::vector<nn::StageHealth>& stages, std::vector<nn::StageHealth>* sums) {
  if (sums->empty()) {
    *sums = stages;
    return;
  }
  for (size_t i = 0; i < stages.size(); ++i) {
    nn::StageHealth& sum = (*sums)[i];
    sum.points += stages[i].points;
    sum.rms += stages[i].rms;
    sum.varying += stages[i].varying;
    sum.entropy += stages[i].entropy;
  }
}

}  // namespace

HealthReport measure_health(const HealthOptions& options) {
  const TrainConfig config = config_of(options);
  RunData data = open_run_data(config);
  nn::LightTransportModel model = model_of(options, config, options.model, data);
  std::vector<Example> examples = validation_examples(config, &data.val);
  if (examples.empty()) examples = validation_examples(config, &data.train);
  LTE_CHECK(!examples.empty(), options.data, ": none of its scenes can be used");

  HealthReport report;
  for (const Example& example : examples)
    add_stages(model->stage_health(example.points), &report.stages);
  const auto count = static_cast<double>(examples.size());
  for (nn::StageHealth& stage : report.stages) {
    stage.points = std::llround(static_cast<double>(stage.points) / count);
    stage.rms /= count;
    stage.varying /= count;
    stage.entropy /= count;
  }

  std::map<std::string, double> moved;
  const fs::path beside = start_path(fs::path(options.model).parent_path());
  const fs::path start = options.start.empty() ? beside : fs::path(options.start);
  if (!options.start.empty() || fs::exists(start)) {
    const WeightMovement movement(model_of(options, config, start.string(), data));
    for (const auto& [module, value] : movement.of(model)) moved[module] = value;
  }
  Optimizer optimizer(config.train, model);
  SceneGradients gradients(config, model, at::kCPU);
  for (const Example& example : examples) gradients.accumulate_alone(example, 1);
  for (const auto& [module, rms] : optimizer.module_rms()) {
    const auto found = moved.find(module);
    report.modules.push_back(
        {module, rms / count,
         found == moved.end() ? std::numeric_limits<double>::quiet_NaN() : found->second});
  }
  return report;
}

std::vector<std::string> HealthReport::faults() const {
  std::vector<std::string> faults;
  for (const nn::StageHealth& stage : stages) {
    if (stage.collapsed())
      faults.push_back(formatted(
          "%s: nearly one vector for all %lld points (%.0f %% of its "
          "features differ between them)",
          stage.stage.c_str(), static_cast<long long>(stage.points), 100 * stage.varying));
  }
  std::vector<double> all;
  for (const ModuleHealth& module : modules) {
    if (std::isfinite(module.moved)) all.push_back(module.moved);
  }
  const double least = 0.1 * median(all);
  for (const ModuleHealth& module : modules) {
    if (module.moved < least)
      faults.push_back(
          formatted("%s: stands still (moved by %.3g of its start, the median module "
                    "by %.3g)",
                    module.module.c_str(), module.moved, 10 * least));
  }
  return faults;
}

}  // namespace lte::train
