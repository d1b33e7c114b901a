#include "train/command/dry_run.h"

#include <cstdio>

#include "lte/base/text.h"
#include "lte/nn/cost.h"
#include "train/log/json.h"
#include "train/optim/optimizer.h"

namespace lte::train {
namespace {

int64_t points_of(const TrainConfig& config) {
  return config.data.scene_points > 0 ? config.data.scene_points : DataConfig().scene_points;
}

int64_t queries_of(const TrainConfig& config) {
  return config.data.queries_per_scene > 0 ? config.data.queries_per_scene
                                           : DataConfig().queries_per_scene;
}

double mebi(double bytes) { return bytes / (1 << 20); }

Json memory_json(const MemoryEstimate& memory) {
  return {
      {"weights", mebi(memory.weights)},         {"gradients", mebi(memory.gradients)},
      {"moments", mebi(memory.moments)},         {"average", mebi(memory.average)},
      {"activations", mebi(memory.activations)}, {"examples", mebi(memory.examples)},
      {"total", mebi(memory.total())},           {"scene_cache_limit", mebi(memory.scene_cache)}};
}

Json shapes_json(const TrainConfig& config) {
  const nn::ModelConfig& model = config.model;
  const int64_t M = points_of(config), m = nn::latent_count(M), Q = queries_of(config),
                D = model.channels;
  return {{"scene_points", {M, model.point_inputs()}},
          {"first_neighbours", {(M + 1) / 2, model.nne_neighbours}},
          {"second_neighbours", {m, model.nne_neighbours}},
          {"embedding", {m, nn::latent_width(model)}},
          {"queries", {Q, model.query_inputs()}},
          {"query_neighbours", {Q, model.query_neighbours}},
          {"keys", {model.query_layers, m, D}},
          {"values", {model.query_layers, m, D}},
          {"irradiance", {Q, 3}}};
}

Json module_counts(const nn::LightTransportModel& model) {
  Json counts = Json::object();
  for (const auto& [module, count] : nn::parameters_by_module(model)) counts[module] = count;
  return counts;
}

/// 41893123 -> "41,893,123".
std::string grouped(int64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string row(const std::string& name, const std::string& value) {
  const std::string gap(name.size() < 24 ? 24 - name.size() : 1, ' ');
  const std::string pad(value.size() < 16 ? 16 - value.size() : 0, ' ');
  return "  " + name + gap + pad + value + "\n";
}

}  // namespace

MemoryEstimate estimate_memory(const TrainConfig& config, const nn::LightTransportModel& model) {
  const int64_t M = points_of(config), Q = queries_of(config);
  int64_t parameters = 0, moments = 0;
  for (const auto& item : model->named_parameters()) {
    const int64_t count = item.value().numel();
    parameters += count;
    moments += uses_muon(config.train, item.key(), item.value()) ? count : 2 * count;
  }
  const double weights = nn::weight_bytes(parameters);
  MemoryEstimate memory;
  memory.weights = weights;
  memory.gradients = weights;
  memory.moments = nn::weight_bytes(moments);
  memory.average = config.train.ema_decay > 0 ? weights : 0;
  memory.activations = nn::activation_bytes(config.model, M, Q);
  memory.examples =
      2 * static_cast<double>(config.train.scenes_per_step) * nn::example_bytes(config.model, M, Q);
  memory.scene_cache = static_cast<double>(config.data.cache_mb) * (1 << 20);
  return memory;
}

Json dry_run(const TrainConfig& config) {
  const nn::LightTransportModel model(config.model);
  const nn::ParameterCounts counts = nn::count_parameters(model);
  Json report;
  report["parameters"] = {{"total", counts.total},
                          {"nne", counts.nne},
                          {"encoder", counts.encoder},
                          {"decoder", counts.decoder}};
  if (config.model.predicts_radiance()) report["parameters"]["radiance"] = counts.radiance;
  report["modules"] = module_counts(model);
  report["shapes"] = shapes_json(config);
  report["memory_mb"] = memory_json(estimate_memory(config, model));
  report["training"] = {{"steps", config.train.steps},
                        {"scenes_per_step", config.train.scenes_per_step},
                        {"queries_per_step", config.train.scenes_per_step * queries_of(config)}};
  return report;
}

std::string dry_run_table(const Json& report) {
  std::string text = "parameters\n";
  for (const auto& [name, count] : report.at("parameters").items())
    text += row(name, grouped(count.get<int64_t>()));
  text += "by module\n";
  for (const auto& [name, count] : report.at("modules").items())
    text += row(name, grouped(count.get<int64_t>()));
  text += "shapes\n";
  for (const auto& [name, shape] : report.at("shapes").items()) text += row(name, shape.dump());
  text += "memory (MiB)\n";
  for (const auto& [name, size] : report.at("memory_mb").items()) {
    text += row(name, formatted("%.1f", size.get<double>()));
  }
  return text;
}

}  // namespace lte::train
