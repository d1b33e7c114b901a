#include "experiments/paper/roadmap_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <ATen/ATen.h>

#include "lte/nn/constants.h"
#include "lte/nn/cost.h"
#include "lte/nn/decoder/query_decoder.h"
#include "lte/nn/encoder/transformer_block.h"
#include "lte/nn/model_parts.h"
#include "lte/ops/knn.h"

namespace lte::experiments {

using nn::Linear;
using nn::Mlp;

GlobalAttentionImpl::GlobalAttentionImpl(int64_t channels, int64_t heads, Attention attention)
    : heads_(heads),
      attention_(attention),
      query_(register_module("query", Linear(channels, channels))),
      key_value_(register_module("key_value", Linear(channels, 2 * channels))),
      output_(register_module("output", Linear(channels, channels))) {
  for (Linear* linear : {&query_, &key_value_, &output_}) nn::initialize(*linear, 1);
}

at::Tensor GlobalAttentionImpl::forward(const at::Tensor& x, const at::Tensor& context) {
  const int64_t N = x.size(-2), C = x.size(-1), n = context.size(-2), d = C / heads_;
  const at::Tensor q = query_->forward(x).view({-1, N, heads_, d}).transpose(1, 2);
  const std::vector<at::Tensor> kv =
      key_value_->forward(context).view({-1, n, 2, heads_, d}).unbind(2);
  const at::Tensor k = kv[0].transpose(1, 2), v = kv[1].transpose(1, 2);
  at::Tensor attended;
  if (attention_ == Attention::Fused) {
    attended = at::scaled_dot_product_attention(q, k, v);
  } else {
    const double scale = 1 / std::sqrt(static_cast<double>(d));
    attended = at::matmul(at::softmax(at::matmul(q * scale, k.transpose(2, 3)), 3), v);
  }
  return output_->forward(attended.transpose(1, 2).reshape(x.sizes()));
}

GlobalBlockImpl::GlobalBlockImpl(int64_t channels, int64_t heads, Attention attention)
    : norm1_(register_module("norm1", nn::LayerNorm(channels))),
      norm2_(register_module("norm2", nn::LayerNorm(channels))),
      attention_(register_module("attention", GlobalAttention(channels, heads, attention))),
      mlp_(register_module("mlp", Mlp(channels, nn::kFfnRatio * channels, channels))) {}

at::Tensor GlobalBlockImpl::forward(const at::Tensor& x) {
  const at::Tensor normed = norm1_->forward(x);
  const at::Tensor sum = x + attention_->forward(normed, normed);
  return sum + mlp_->forward(norm2_->forward(sum));
}

NeighbourMeanImpl::NeighbourMeanImpl(int64_t features, const nn::ModelConfig& config)
    : neighbours_(config.query_neighbours) {
  const int64_t D = config.channels;
  point_ = register_module("point", Mlp(config.query_inputs(), D, D));
  head_ =
      register_module("head", Mlp(D + features, nn::kFfnRatio * D, 3, 0, nn::first_gain(config)));
  const at::NoGradGuard no_grad;
  head_->output()->bias.fill_(nn::softplus_inverse(config.output_mean));
}

at::Tensor NeighbourMeanImpl::forward(const at::Tensor& attributes, const at::Tensor& position,
                                      const at::Tensor& anchor, const at::Tensor& features) {
  const at::Tensor index = std::get<0>(ops::knn(position.to(at::kFloat).contiguous(),
                                                anchor.to(at::kFloat).contiguous(), neighbours_));
  const int64_t Q = index.size(0), K = index.size(1);
  const at::Tensor mean =
      features.index_select(0, index.reshape({-1})).view({Q, K, features.size(1)}).mean(1);
  return at::softplus(head_->forward(at::cat({point_->forward(attributes), mean}, 1)));
}

RoadmapModelImpl::RoadmapModelImpl(RoadmapNetwork network, const nn::ModelConfig& config,
                                   Attention attention)
    : network_(network), config_(config) {
  const int64_t D = config.channels;
  if (network == RoadmapNetwork::Vanilla) {
    point_ = register_module("point", Mlp(config.point_inputs(), D, D));
    const int64_t heads = std::max<int64_t>(1, D / config.head_width);
    for (int64_t i = 0; i < kVanillaLayers; ++i)
      blocks_.push_back(
          register_module("block" + std::to_string(i), GlobalBlock(D, heads, attention)));
    norm_ = register_module("norm", nn::LayerNorm(D));
    pool_ = register_module("pool", NeighbourMean(D, config));
    return;
  }
  model_ = register_module("model", nn::LightTransportModel(config));
  if (network == RoadmapNetwork::Whole) return;
  pool_ = register_module("pool", NeighbourMean(nn::latent_width(config), config));
  for (const auto& parameter : model_->named_parameters()) {
    if (parameter.key().starts_with("decoder.")) parameter.value().requires_grad_(false);
  }
}

std::vector<RoadmapModelImpl::Latents> RoadmapModelImpl::vanilla(
    const std::vector<nn::PointSet>& points) {
  std::vector<Latents> out;
  std::vector<at::Tensor> inputs;
  for (const nn::PointSet& scene : points) {
    const at::Tensor origin = std::get<0>(scene.position.min(0));
    const at::Tensor position = (scene.position - origin).div(config_.scale);
    const at::Tensor scale = nn::emission_scale(scene).to(scene.emission.options());
    const at::Tensor emission = at::log1p(scene.emission / at::where(scale > 0, scale, 1));
    inputs.push_back(
        at::cat({nn::surface_attributes(position, scene.normal, scene.albedo), emission}, 1));
    out.push_back({origin, position, {}});
  }
  at::Tensor x = point_->forward(at::stack(inputs));
  for (GlobalBlock& block : blocks_) x = block->forward(x);
  x = norm_->forward(x);
  for (size_t i = 0; i < out.size(); ++i) out[i].features = x[static_cast<int64_t>(i)];
  return out;
}

std::vector<at::Tensor> RoadmapModelImpl::forward(const std::vector<nn::PointSet>& points,
                                                  const std::vector<nn::QuerySet>& queries,
                                                  const std::vector<uint64_t>& order_seeds) {
  std::vector<Latents> latents;
  if (network_ == RoadmapNetwork::Vanilla) {
    latents = vanilla(points);
  } else {
    const nn::SceneBatch batch = model_->encode_batch(points, order_seeds);
    if (network_ == RoadmapNetwork::Whole) return model_->decode_normalized(batch, queries);
    int64_t begin = 0;
    for (const nn::Embedding& scene : batch.scenes) {
      const int64_t count = scene.position.size(0);
      latents.push_back({scene.origin, scene.position, batch.features.narrow(0, begin, count)});
      begin += count;
    }
  }
  std::vector<at::Tensor> answers;
  for (size_t i = 0; i < queries.size(); ++i) {
    const nn::QuerySet& query = queries[i];
    const at::Tensor position = (query.position - latents[i].origin).div(config_.scale);
    answers.push_back(pool_->forward(nn::surface_attributes(position, query.normal, query.albedo),
                                     position, latents[i].position, latents[i].features));
  }
  return answers;
}

}  // namespace lte::experiments
