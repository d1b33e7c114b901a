#include "train/command/health_command.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "lte/base/text.h"
#include "lte/nn/model_metadata.h"
#include "train/checkpoint/checkpoint.h"
#include "train/checkpoint/init_weights.h"
#include "train/checkpoint/model_files.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/loop/scene_gradients.h"
#include "train/optim/optimizer.h"
#include "train/optim/weight_movement.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

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

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

std::string figure(double value) { return std::isfinite(value) ? formatted("%.3g", value) : "-"; }

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json health_json(const HealthReport& report) {
  Json json = {{"stages", Json::array()}, {"modules", Json::array()}, {"faults", report.faults()}};
  for (const nn::StageHealth& stage : report.stages) {
    json["stages"].push_back({{"stage", stage.stage},
                              {"points", stage.points},
                              {"rms", stage.rms},
                              {"varying", stage.varying},
                              {"entropy", number_or_null(stage.entropy)}});
  }
  for (const ModuleHealth& module : report.modules) {
    json["modules"].push_back({{"module", module.module},
                               {"gradient_rms", module.gradient_rms},
                               {"moved", number_or_null(module.moved)}});
  }
  return json;
}

}  // namespace

CLI::App* add_health_command(CLI::App& app, HealthOptions* options) {
  auto* health = app.add_subcommand(
      "health", "Say what each stage of a trained network carries, and whether all of it learns");
  health->add_option("MODEL", options->model, "Model file or checkpoint of lte_train")->required();
  health->add_option("--data", options->data, "Data set to try it on")->required();
  health->add_option("--scenes", options->scenes, "Scenes to take the mean over")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  health->add_option("--start", options->start,
                     "The run's first weights; by default start.safetensors beside the model");
  return health;
}

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

std::string health_table(const HealthReport& report) {
  std::string text = "stage     points       rms   varying   entropy\n";
  for (const nn::StageHealth& stage : report.stages)
    text += formatted("%-8s %7lld %9s %9s %9s\n", stage.stage.c_str(),
                      static_cast<long long>(stage.points), figure(stage.rms).c_str(),
                      figure(stage.varying).c_str(), figure(stage.entropy).c_str());
  text += "\nmodule           gradient rms     moved\n";
  for (const ModuleHealth& module : report.modules)
    text += formatted("%-16s %12s %9s\n", module.module.c_str(),
                      figure(module.gradient_rms).c_str(), figure(module.moved).c_str());
  text += "\n";
  const std::vector<std::string> faults = report.faults();
  for (const std::string& fault : faults) text += fault + "\n";
  if (faults.empty()) text += "every stage tells its points apart, and nothing stands still\n";
  return text;
}

std::string run_health(const HealthOptions& options) {
  const HealthReport report = measure_health(options);
  if (!options.json.empty()) write_file(options.json, health_json(report).dump(2) + "\n");
  return health_table(report);
}

}  // namespace lte::train
