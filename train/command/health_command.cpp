#include "train/command/health_command.h"

#include <cmath>

#include "lte/base/file.h"
#include "lte/base/json_number.h"
#include "lte/base/text.h"
#include "train/log/json.h"

namespace lte::train {
namespace {

std::string figure(double value) { return std::isfinite(value) ? formatted("%.3g", value) : "-"; }

Json health_json(const HealthReport& report) {
  Json json = {{"stages", Json::array()}, {"modules", Json::array()}, {"faults", report.faults()}};
  for (const nn::StageHealth& stage : report.stages) {
    json["stages"].push_back({{"stage", stage.stage},
                              {"points", stage.points},
                              {"rms", stage.rms},
                              {"varying", stage.varying},
                              {"entropy", json_number(stage.entropy)}});
  }
  for (const ModuleHealth& module : report.modules) {
    json["modules"].push_back({{"module", module.module},
                               {"gradient_rms", module.gradient_rms},
                               {"moved", json_number(module.moved)}});
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
