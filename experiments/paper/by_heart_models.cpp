#include "experiments/paper/by_heart_models.h"

#include <cmath>
#include <vector>

#include <ATen/ATen.h>
#include <torch/types.h>

#include "lte/ops/gelu.h"

namespace lte::experiments {
namespace {

constexpr int64_t kHidden = 64;
constexpr double kFirstEntries = 1e-4;
constexpr int64_t kPrimes[3] = {1, 2654435761, 805459861};  // of Müller et al. 2022

}  // namespace

HashGridImpl::HashGridImpl(const HashGridConfig& config)
    : config_(config),
      table_(register_parameter(
          "table", at::empty({config.levels, int64_t{1} << config.log2_entries, config.features})
                       .uniform_(-kFirstEntries, kFirstEntries))) {}

int64_t HashGridImpl::cells(int64_t level) const {
  return static_cast<int64_t>(static_cast<double>(config_.base) *
                              std::pow(config_.growth, static_cast<double>(level)));
}

std::tuple<at::Tensor, at::Tensor> HashGridImpl::corners(const at::Tensor& position,
                                                         int64_t level) const {
  const int64_t side = cells(level), entries = table_.size(1), row = side + 1;
  const at::Tensor scaled = position.to(at::kDouble).clamp(0, 1) * side;
  const at::Tensor low = scaled.floor().clamp_max(static_cast<double>(side - 1));
  const at::Tensor fraction = scaled - low, cell = low.to(at::kLong);
  const bool dense = row * row * row <= entries;
  std::vector<at::Tensor> index, weight;
  for (int64_t corner = 0; corner < 8; ++corner) {
    at::Tensor entry, share;
    for (int64_t axis = 0; axis < 3; ++axis) {
      const int64_t bit = (corner >> axis) & 1;
      const at::Tensor place = cell.select(1, axis) + bit, f = fraction.select(1, axis);
      const at::Tensor w = bit == 1 ? f : 1 - f;
      share = axis == 0 ? w : share * w;
      if (dense) {
        entry = axis == 0 ? place : entry + place * (axis == 1 ? row : row * row);
      } else {
        const at::Tensor hashed = place * kPrimes[axis];
        entry = axis == 0 ? hashed : at::bitwise_xor(entry, hashed);
      }
    }
    index.push_back(dense ? entry : at::bitwise_and(entry, entries - 1));
    weight.push_back(share);
  }
  return {at::stack(index, 1), at::stack(weight, 1).to(table_.scalar_type())};
}

at::Tensor HashGridImpl::forward(const at::Tensor& position) {
  const int64_t Q = position.size(0);
  std::vector<at::Tensor> out;
  for (int64_t level = 0; level < config_.levels; ++level) {
    const auto [index, weight] = corners(position, level);
    const at::Tensor features =
        table_.select(0, level).index_select(0, index.reshape({-1})).view({Q, 8, config_.features});
    out.push_back((features * weight.unsqueeze(2)).sum(1));
  }
  return at::cat(out, 1);
}

GridByHeart::GridByHeart(const HashGridConfig& config, double extent, double output_mean)
    : extent_(extent),
      grid_(register_module("grid", HashGrid(config))),
      hidden_(register_module("hidden", nn::Mlp(config.levels * config.features + 6, kHidden,
                                                kHidden, 0, std::sqrt(2.0)))),
      head_(register_module("head", nn::Mlp(kHidden, kHidden, 3, 0, 0.1))) {
  const at::NoGradGuard no_grad;
  head_->output()->bias.fill_(nn::softplus_inverse(output_mean));
}

at::Tensor GridByHeart::forward(const at::Tensor& attributes, const nn::Surface& query) {
  const at::Tensor features = grid_->forward(query.position / extent_);
  const at::Tensor x = at::cat({features, attributes.narrow(1, 3, 6)}, 1);
  return at::softplus(head_->forward(ops::gelu(hidden_->forward(x))));
}

LatentsByHeart::LatentsByHeart(LatentReader reader, const nn::Surface& anchor, double spacing,
                               const nn::ModelConfig& config)
    : anchor_(anchor),
      spacing_(spacing),
      latents_(
          register_parameter("latents", at::randn({anchor.position.size(0), config.channels}))) {
  if (reader == LatentReader::Mean) {
    pool_ = register_module("pool", NeighbourMean(config.channels, config));
  } else {
    decoder_ = register_module("decoder", nn::QueryDecoder(config.channels, config));
  }
}

at::Tensor LatentsByHeart::forward(const at::Tensor& attributes, const nn::Surface& query) {
  if (pool_) return pool_->forward(attributes, query.position, anchor_.position, latents_);
  return decoder_->forward(attributes, {{query, anchor_, spacing_}},
                           decoder_->latent_tables(latents_));
}

}  // namespace lte::experiments
