#include "train/command/dry_run.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/nn/recompute.h"

namespace lte::train {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFloat = 4, kIndex = 8;

double real(int64_t value) { return static_cast<double>(value); }

int64_t points_of(const TrainConfig& config) {
  return config.data.scene_points > 0 ? config.data.scene_points : DataConfig().scene_points;
}

int64_t queries_of(const TrainConfig& config) {
  return config.data.queries_per_scene > 0 ? config.data.queries_per_scene
                                           : DataConfig().queries_per_scene;
}

int64_t latents_of(int64_t points) { return std::max<int64_t>(1, points / 4); }

/// Numbers of pairs, `tensors` of a kind, that exist at once: what is more than a block is
/// recomputed.
double pair_floats(double numbers, double tensors) {
  return tensors * std::min(numbers, real(nn::kPairNumbers));
}

/// Kept by F and both neighbour maxima, three tensors a pair; and of blocks that are recomputed the
/// gradients by what they read, two for each number of the points.
double embedding_floats(const nn::ModelConfig& model, double M) {
  const double D = real(model.channels), k = real(model.nne_neighbours);
  return 8 * M * D + pair_floats(M / 2 * k * D, 3) + pair_floats(M / 4 * k * D, 3);
}

/// Kept by the blocks of one stage: inputs and outputs of convolution, norms, attention (qkv in
/// both orders), and an MLP of four times the width before and after its activation and dropout.
double stage_floats(double points, double channels, int64_t depth) {
  constexpr double kTensorsOfWidth = 31;
  return kTensorsOfWidth * points * channels * real(depth);
}

double encoder_floats(const nn::ModelConfig& model, double m) {
  constexpr double kPooling = 4;  // a surface in cells of twice the size
  const double D = real(model.channels);
  double floats = 0, points = m;
  for (size_t s = 0; s < model.encoder_depths.size(); ++s) {
    floats += stage_floats(points, D * real(model.encoder_widths[s]), model.encoder_depths[s]);
    if (s < model.decoder_depths.size()) {
      const double width = D * real(model.decoder_widths[s]);
      floats += stage_floats(points, width, model.decoder_depths[s]) + 6 * points * width;
    }
    points = std::max(1.0, points / kPooling);
  }
  return floats;
}

double decoder_floats(const nn::ModelConfig& model, double m, double Q) {
  const double D = real(model.channels), L = real(model.query_layers),
               K = real(model.query_neighbours);
  const double tables = 4 * L * m * D;  // keys and values, and stacked
  const double pairs = Q * K * 3 + pair_floats(Q * K * real(model.gamma_hidden), 2) +
                       pair_floats(Q * K * D, 2) +  // γ, its output and that one's gradient
                       (model.normalizes_attention() ? pair_floats(Q * K * D, 8) : 0);
  const double layers = L * Q * D * (14 + 3 * real(model.ffn_ratio));
  return tables + pairs + layers;
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
  const int64_t M = points_of(config), m = latents_of(M), Q = queries_of(config),
                D = model.channels;
  const int64_t latent =
      D * (model.decoder_widths.empty() ? model.encoder_widths[0] : model.decoder_widths[0]);
  return {{"scene_points", {M, model.point_inputs()}},
          {"first_neighbours", {M / 2, model.nne_neighbours}},
          {"second_neighbours", {m, model.nne_neighbours}},
          {"embedding", {m, latent}},
          {"queries", {Q, model.query_inputs()}},
          {"query_neighbours", {Q, model.query_neighbours}},
          {"keys", {model.query_layers, m, D}},
          {"values", {model.query_layers, m, D}},
          {"irradiance", {Q, 3}}};
}

/// Parameters of each module two levels deep: "encoder.down3", "decoder.layer0".
Json module_counts(const nn::LightTransportModel& model) {
  Json counts = Json::object();
  for (const auto& item : model->named_parameters()) {
    const std::string& name = item.key();
    const std::string module = name.substr(0, name.find('.', name.find('.') + 1));
    counts[module] = counts.value(module, int64_t{0}) + item.value().numel();
  }
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

MemoryEstimate estimate_memory(const TrainConfig& config, int64_t parameters) {
  const double P = real(parameters), M = real(points_of(config)), Q = real(queries_of(config));
  const double m = real(latents_of(points_of(config)));
  MemoryEstimate memory;
  memory.weights = memory.gradients = kFloat * P;
  memory.moments = 2 * kFloat * P;
  memory.average = config.train.ema_decay > 0 ? kFloat * P : 0;
  const double floats = embedding_floats(config.model, M) + encoder_floats(config.model, m) +
                        decoder_floats(config.model, m, Q);
  const double neighbours =
      (0.75 * M * real(config.model.nne_neighbours) + Q * real(config.model.query_neighbours));
  memory.activations = kFloat * floats + kIndex * neighbours;
  memory.examples = 2 * real(config.train.scenes_per_step) * kFloat *
                    ((real(config.model.point_inputs()) + 1) * M + 12 * Q);
  memory.scene_cache = real(config.data.cache_mb) * (1 << 20);
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
  report["modules"] = module_counts(model);
  report["shapes"] = shapes_json(config);
  report["memory_mb"] = memory_json(estimate_memory(config, counts.total));
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
