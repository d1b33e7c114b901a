#include "lte/nn/cost.h"

#include <algorithm>

#include "lte/nn/blocks/recompute.h"
#include "lte/nn/constants.h"
#include "lte/nn/encoder/encoder_plan.h"
#include "lte/nn/model.h"
#include "lte/nn/points/surfels.h"

namespace lte::nn {
namespace {

constexpr double kFloat = 4, kIndex = 8;  // bytes
constexpr double kMiB = 1 << 20;

double real(int64_t value) { return static_cast<double>(value); }

/// Multiply-adds of one block of width C on a stage.
double block_products(const ModelConfig& config, const StagePlan& stage, int64_t C) {
  const double n = real(stage.points()), width = real(C);
  const bool one_patch = stage.points() <= config.patch_size;
  const double slots = one_patch ? n : real(stage.scenes[0].patches[0].gather.size(0));
  const double convolution = real(stage.pairs.size(1)) * width * width;
  const double dense = (1 + 4 + 8) * n * width * width;  // after the convolution; attention; MLP
  return convolution + dense + 2 * slots * (one_patch ? n : real(config.patch_size)) * width;
}

/// Multiply-adds of F and both halvings.
double embedding_products(const ModelConfig& config, const EncoderPlan& plan, int64_t M) {
  const double D = real(config.channels), points = real(M), m1 = real(plan.first_picks.size(0)),
               m = real(plan.position.size(0));
  const double pairs = real(plan.first_neighbours.numel() + plan.second_neighbours.numel());
  return points * (real(config.point_inputs()) * D + D * D) + (points + 2 * m1 + m + pairs) * D * D;
}

/// Multiply-adds of a stage's blocks on the way down and of what leads to it.
double down_products(const ModelConfig& config, const EncoderPlan& plan, size_t s) {
  const int64_t width = config.encoder_widths[s] * config.channels;
  double products = real(config.encoder_depths[s]) * block_products(config, plan.stages[s], width);
  if (s > 0) {
    products +=
        real(plan.stages[s - 1].points() * width * config.encoder_widths[s - 1] * config.channels);
  }
  return products;
}

/// Multiply-adds of a stage's blocks on the way up, and of the unpooling that leads to it.
double up_products(const ModelConfig& config, const EncoderPlan& plan, size_t s) {
  const StagePlan& stage = plan.stages[s];
  const int64_t down = config.encoder_widths[s] * config.channels;
  const int64_t up = config.decoder_widths[s] * config.channels;
  const bool deepest = s + 2 == plan.stages.size();
  const int64_t below =
      config.channels * (deepest ? config.encoder_widths[s + 1] : config.decoder_widths[s + 1]);
  return real(config.decoder_depths[s]) * block_products(config, stage, up) +
         real(stage.points()) * real(down * up) + real(plan.stages[s + 1].points() * below * up);
}

/// Floats of `tensors` tensors of so many numbers of pairs. What is more than a block is
/// recomputed, so that no more exists at once.
double pair_floats(double numbers, double tensors) {
  return tensors * std::min(numbers, real(kPairNumbers));
}

/// Kept by F and both neighbour maxima: three tensors a pair, and of blocks that are recomputed the
/// gradients by what they read, two for each number of the points.
double embedding_floats(const ModelConfig& config, double M) {
  const double D = real(config.channels), k = real(config.nne_neighbours);
  return 8 * M * D + pair_floats(M / 2 * k * D, 3) + pair_floats(M / 4 * k * D, 3);
}

/// Kept by the blocks of one stage: inputs and outputs of convolution, norms, attention (qkv in
/// both orders), and an MLP of four times the width before and after its activation and dropout.
double stage_floats(double points, double channels, int64_t depth) {
  constexpr double kTensorsOfWidth = 31;
  return kTensorsOfWidth * points * channels * real(depth);
}

double encoder_floats(const ModelConfig& config, double m) {
  constexpr double kPooling = 4;  // a surface in cells of twice the size
  const double D = real(config.channels);
  double floats = 0, points = m;
  for (size_t s = 0; s < config.encoder_depths.size(); ++s) {
    floats += stage_floats(points, D * real(config.encoder_widths[s]), config.encoder_depths[s]);
    if (s < config.decoder_depths.size()) {
      const double width = D * real(config.decoder_widths[s]);
      floats += stage_floats(points, width, config.decoder_depths[s]) + 6 * points * width;
    }
    points = std::max(1.0, points / kPooling);
  }
  return floats;
}

double decoder_floats(const ModelConfig& config, double m, double Q) {
  const double D = real(config.channels), L = real(config.query_layers),
               K = real(config.query_neighbours);
  const double tables = 4 * L * m * D;  // keys and values, and stacked
  const double pairs = Q * K * real(config.pair_inputs()) +
                       pair_floats(Q * K * real(kGammaHidden), 2) +
                       pair_floats(Q * K * D, 2);  // γ, its output and that one's gradient
  const double layers = L * Q * D * (14 + 3 * real(kFfnRatio));
  return tables + pairs + layers;
}

}  // namespace

ParameterCounts count_parameters(const LightTransportModel& model) {
  ParameterCounts counts;
  for (const auto& [module, n] : parameters_by_module(model)) {
    counts.total += n;
    if (module.starts_with("nne.")) counts.nne += n;
    if (module.starts_with("encoder.")) counts.encoder += n;
    if (module.starts_with("decoder.")) counts.decoder += n;
    if (module.starts_with("radiance.")) counts.radiance += n;
  }
  return counts;
}

std::vector<std::pair<std::string, int64_t>> parameters_by_module(
    const LightTransportModel& model) {
  std::vector<std::pair<std::string, int64_t>> counts;
  for (const auto& item : model->named_parameters()) {
    const std::string& name = item.key();
    const std::string module = name.substr(0, name.find('.', name.find('.') + 1));
    const auto found = std::find_if(counts.begin(), counts.end(),
                                    [&](const auto& entry) { return entry.first == module; });
    if (found == counts.end()) {
      counts.emplace_back(module, item.value().numel());
    } else {
      found->second += item.value().numel();
    }
  }
  return counts;
}

int64_t latent_count(int64_t scene_points) { return ((scene_points + 1) / 2 + 1) / 2; }

int64_t latent_width(const ModelConfig& config) {
  const auto& widths =
      config.decoder_widths.empty() ? config.encoder_widths : config.decoder_widths;
  return widths[0] * config.channels;
}

double encode_flops(const ModelConfig& config, const EncoderPlan& plan, int64_t M) {
  const double D = real(config.channels), m = real(plan.position.size(0));
  double products = embedding_products(config, plan, M);
  products += D * D * real(config.encoder_widths[0]) * real(plan.stem_pairs.size(1));
  for (size_t s = 0; s < plan.stages.size(); ++s) products += down_products(config, plan, s);
  for (size_t s = 0; s + 1 < plan.stages.size(); ++s) products += up_products(config, plan, s);
  products += 2 * real(config.query_layers) * m * real(latent_width(config)) * D;  // the table
  return 2 * products;
}

double decode_flops(const ModelConfig& config, int64_t m) {
  const double D = real(config.channels), L = real(config.query_layers), h = real(kGammaHidden),
               ratio = real(kFfnRatio), near = real(std::min(config.query_neighbours, m));
  const double point = real(config.query_inputs()) * D + D * D, head = D * D + 3 * D;
  const double gamma = near * (real(config.pair_inputs()) * h + h * D), sums = 2 * near * L * D;
  const double layers = L * (2 + 2 * ratio) * D * D;
  return 2 * (point + gamma + sums + layers + head);
}

double weight_bytes(int64_t parameters) { return kFloat * real(parameters); }

double activation_bytes(const ModelConfig& config, int64_t M, int64_t Q) {
  const double points = real(M), queries = real(Q), m = real(latent_count(M));
  const double floats = embedding_floats(config, points) + encoder_floats(config, m) +
                        decoder_floats(config, m, queries);
  const double neighbours =
      0.75 * points * real(config.nne_neighbours) + queries * real(config.query_neighbours);
  return kFloat * floats + kIndex * neighbours;
}

double example_bytes(const ModelConfig& config, int64_t M, int64_t Q) {
  constexpr double kArea = 1, kQuery = 12;  // numbers; a query's position, normal, albedo, answer
  return kFloat * ((real(config.point_inputs()) + kArea) * real(M) + kQuery * real(Q));
}

}  // namespace lte::nn
