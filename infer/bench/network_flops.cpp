#include "infer/bench/network_flops.h"

#include <algorithm>

namespace lte::infer {
namespace {

/// Multiply-adds of one block of width C on a stage.
double block_products(const nn::ModelConfig& config, const nn::StagePlan& stage, int64_t C) {
  const auto n = static_cast<double>(stage.points()), width = static_cast<double>(C);
  const bool one_patch = stage.points() <= config.patch_size;
  const double patch = static_cast<double>(config.patch_size);
  const double slots = one_patch ? n : static_cast<double>(stage.patches[0].gather.size(0));
  const double convolution = static_cast<double>(stage.pairs.size(1)) * width * width;
  const double dense = (1 + 4 + 8) * n * width * width;  // after the convolution; attention; MLP
  return convolution + dense + 2 * slots * (one_patch ? n : patch) * width;
}

}  // namespace

double encoder_flops(const nn::ModelConfig& config, const nn::EncoderPlan& plan, int64_t M) {
  const auto D = static_cast<double>(config.channels), points = static_cast<double>(M),
             m1 = static_cast<double>(plan.first_picks.size(0)),
             m = static_cast<double>(plan.position.size(0));
  const double pairs =
      static_cast<double>(plan.first_neighbours.numel() + plan.second_neighbours.numel());
  double products = points * (static_cast<double>(config.point_inputs()) * D + D * D);
  products += (points + 2 * m1 + m + pairs) * D * D;  // both halvings
  products += D * D * static_cast<double>(config.encoder_widths[0]) *
              (plan.stem_pairs.defined() ? static_cast<double>(plan.stem_pairs.size(1)) : m);
  const size_t stages = plan.stages.size();
  for (size_t s = 0; s < stages; ++s) {
    const nn::StagePlan& stage = plan.stages[s];
    const auto n = static_cast<double>(stage.points());
    const int64_t down = config.encoder_widths[s] * config.channels;
    products += static_cast<double>(config.encoder_depths[s]) * block_products(config, stage, down);
    if (s > 0) {
      products += static_cast<double>(plan.stages[s - 1].points() * down *
                                      config.encoder_widths[s - 1] * config.channels);
    }
    if (s + 1 == stages) continue;
    const int64_t up = config.decoder_widths[s] * config.channels;
    const int64_t below = config.channels * (s + 2 < stages ? config.decoder_widths[s + 1]
                                                            : config.encoder_widths[s + 1]);
    products += static_cast<double>(config.decoder_depths[s]) * block_products(config, stage, up);
    products += n * static_cast<double>(down * up) +
                static_cast<double>(plan.stages[s + 1].points() * below * up);
  }
  const double latent =
      static_cast<double>(stages > 1 ? config.decoder_widths[0] : config.encoder_widths[0]) * D;
  products += 2 * static_cast<double>(config.query_layers) * m * latent * D;  // the decoder's table
  return 2 * products;
}

double decoder_flops(const nn::ModelConfig& config, int64_t m) {
  const auto D = static_cast<double>(config.channels), L = static_cast<double>(config.query_layers),
             h = static_cast<double>(config.gamma_hidden),
             ratio = static_cast<double>(config.ffn_ratio),
             near = static_cast<double>(std::min(config.query_neighbours, m));
  const double point = static_cast<double>(config.query_inputs()) * D + D * D, head = D * D + 3 * D;
  const double gamma = near * (3 * h + h * D), sums = 2 * near * L * D;
  const double weights = config.normalizes_attention() ? near * 2 * D * D : 0;
  const double layers = L * ((2 + 2 * ratio) * D * D + weights);
  return 2 * (point + gamma + sums + layers + head);
}

}  // namespace lte::infer
