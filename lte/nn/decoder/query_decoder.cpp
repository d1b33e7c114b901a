#include "lte/nn/decoder/query_decoder.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lte/nn/blocks/recompute.h"
#include "lte/nn/constants.h"
#include "lte/nn/decoder/query_order.h"
#include "lte/ops/knn.h"
#include "lte/ops/linear.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/neighbour_sums_args.h"
#include "lte/ops/query_decoder.h"

namespace lte::nn {
namespace {

/// Latents whose keys and values are made at a time where a copy puts them into the table, which
/// so exists once: 100 MB at D = 128 and six layers.
constexpr int64_t kTableChunk = 8192;

/// Whether the channels of keys and values fill the blocks of ops::neighbour_table().
bool fills_table_blocks(const std::vector<QueryLayer>& layers) {
  return layers.front()->key()->weight.size(0) % ops::kTableBlock == 0;
}

/// The table, which one product makes of weights in its order; the channels fill its blocks. `gap`
/// numbers follow each latent.
at::Tensor arranged_table(const std::vector<QueryLayer>& layers, const at::Tensor& latent,
                          int64_t gap) {
  std::vector<at::Tensor> weights, biases;
  for (const QueryLayer& layer : layers) {
    for (const Linear& linear : {layer->key(), layer->value()}) {
      weights.push_back(linear->inference_weight());
      biases.push_back(linear->bias);
    }
  }
  const auto L = static_cast<int64_t>(layers.size());
  const int64_t blocks = weights[0].size(0) / ops::kTableBlock, width = latent.size(1);
  const auto arranged = [&](const std::vector<at::Tensor>& of, int64_t columns) {
    const at::Tensor rows = at::cat(of)
                                .view({L, 2, blocks, ops::kTableBlock, columns})
                                .permute({2, 0, 1, 3, 4})
                                .reshape({-1, columns});
    return gap > 0 ? at::constant_pad_nd(rows, {0, 0, 0, gap}) : rows;
  };
  const at::Tensor all = layers.front()->key()->product(latent, arranged(weights, width),
                                                        arranged(biases, 1).squeeze(1));
  return all.narrow(1, 0, all.size(1) - gap).view({latent.size(0), blocks, L, 2, ops::kTableBlock});
}

}  // namespace

QueryLayerImpl::QueryLayerImpl(int64_t latent, const ModelConfig& config)
    : dropout_(config.dropout),
      norm1_(register_module("norm1", LayerNorm(config.channels))),
      norm2_(register_module("norm2", LayerNorm(config.channels))),
      query_(register_module("query", Linear(config.channels, config.channels))),
      key_(register_module("key", Linear(latent, config.channels))),
      value_(register_module("value", Linear(latent, config.channels))),
      output_(register_module("output", Linear(config.channels, config.channels))) {
  // Two branches a layer add up: this keeps the sum of all of them O(1).
  const double branch = 1 / std::sqrt(2.0 * static_cast<double>(config.query_layers));
  const int64_t D = config.channels;
  for (Linear* linear : {&query_, &key_, &value_}) initialize(*linear, 1);
  initialize(output_, branch);
  ffn_ = register_module("ffn", Mlp(D, kFfnRatio * D, D, config.dropout, branch));
}

std::tuple<at::Tensor, at::Tensor> QueryLayerImpl::keys_and_values(const at::Tensor& latent) {
  return {key_->forward(latent), value_->forward(latent)};
}

at::Tensor QueryLayerImpl::forward(const at::Tensor& G, const at::Tensor& S1, const at::Tensor& S2,
                                   int64_t neighbours) {
  return advance(G, at::addcmul(S2, query(G), S1).mul_(1 / static_cast<double>(neighbours)));
}

at::Tensor QueryLayerImpl::advance(const at::Tensor& G, const at::Tensor& attended) {
  const at::Tensor branch = at::dropout(output_->forward(attended), dropout_, is_training());
  const at::Tensor sum = G + branch;
  return sum + ffn_->forward(norm2_->forward(sum));
}

ops::LayerWeights QueryLayerImpl::weights() const {
  return {{norm1_->weight, norm1_->bias},
          query_->weights(),
          output_->weights(),
          {norm2_->weight, norm2_->bias},
          ffn_->weights()};
}

double softplus_inverse(double value) {
  return value + std::log(-std::expm1(-value));  // the form that does not overflow
}

double first_gain(const ModelConfig& config) { return config.reads_light() ? 0.01 : 0.1; }

QueryDecoderImpl::QueryDecoderImpl(int64_t latent, const ModelConfig& config, int64_t features)
    : neighbours_(config.query_neighbours),
      dropout_(config.dropout),
      reads_normals_(config.reads_normals()) {
  const int64_t D = config.channels;
  point_ = register_module("point", Mlp(config.query_inputs(), D, D));
  point_->hidden()->keep_float32();
  gamma_ = register_module("gamma", Mlp(config.pair_inputs(), kGammaHidden, D));
  for (int64_t i = 0; i < config.query_layers; ++i) {
    layers_.push_back(register_module("layer" + std::to_string(i), QueryLayer(latent, config)));
  }
  norm_ = register_module("norm", LayerNorm(D));
  if (features > 0) {
    head_ = register_module("head", Mlp(D, D, features));
    return;
  }
  head_ = register_module("head", Mlp(D, D, 3, 0, first_gain(config)));
  const at::NoGradGuard no_grad;
  head_->output()->bias.fill_(softplus_inverse(config.output_mean));
}

std::tuple<at::Tensor, at::Tensor> QueryDecoderImpl::keys_and_values(const at::Tensor& latent) {
  std::vector<at::Tensor> keys, values;
  for (QueryLayer& layer : layers_) {
    auto [key, value] = layer->keys_and_values(latent);
    keys.push_back(key);
    values.push_back(value);
  }
  return {at::stack(keys), at::stack(values)};
}

at::Tensor QueryDecoderImpl::table(const at::Tensor& latent) {
  if (latent.device().is_cpu() && fills_table_blocks(layers_)) {
    return arranged_table(layers_, latent, ops::kTableGap);
  }
  const int64_t m = latent.size(0);
  const int64_t chunks = latent.device().is_cpu() ? std::max<int64_t>(1, m / kTableChunk) : 1;
  at::Tensor out;
  for (int64_t i = 0; i < chunks; ++i) {
    const int64_t begin = m * i / chunks, end = m * (i + 1) / chunks;
    const auto [keys, values] = keys_and_values(latent.slice(0, begin, end));
    at::Tensor part = ops::neighbour_table(keys, values);
    if (chunks == 1) return part;
    if (!out.defined()) {
      std::vector<int64_t> shape = part.sizes().vec();
      shape[0] = m;
      out = at::empty_strided(shape, part.strides(), part.options());
    }
    out.slice(0, begin, end).copy_(part);
  }
  return out;
}

at::Tensor QueryDecoderImpl::nearest(const at::Tensor& query, const at::Tensor& anchor) const {
  return std::get<0>(ops::knn(query.to(at::kFloat).contiguous(), anchor, neighbours_));
}

QueryDecoderImpl::Neighbourhood QueryDecoderImpl::neighbourhood(const Surface& query,
                                                                const Surface& anchor,
                                                                double spacing) const {
  Neighbourhood near;
  near.index = nearest(query.position, anchor.position);
  const int64_t Q = near.index.size(0), K = near.index.size(1);
  const at::Tensor rows = near.index.reshape({-1});
  const auto at_anchor = [&](const at::Tensor& of) {
    return of.to(query.position.scalar_type()).index_select(0, rows).view({Q, K, 3});
  };
  const at::Tensor offset = (query.position.unsqueeze(1) - at_anchor(anchor.position))
                                .mul_(1 / spacing)
                                .clamp_(-kOffsetLimit, kOffsetLimit);
  if (!reads_normals_) {
    near.geometry = offset;
    return near;
  }
  const at::Tensor here = query.normal.unsqueeze(1), there = at_anchor(anchor.normal);
  const auto cosine = [](const at::Tensor& a, const at::Tensor& b) {
    return (a * b).sum(2, /*keepdim=*/true);
  };
  near.geometry =
      at::cat({offset, cosine(here, there), cosine(here, offset), cosine(there, offset)}, 2);
  return near;
}

at::Tensor QueryDecoderImpl::forward(const at::Tensor& attributes, const Neighbourhood& near,
                                     const at::Tensor& keys, const at::Tensor& values) {
  const auto [S1, S2] = neighbour_sums(near, keys, values);
  return run_layers(attributes, S1, S2, near.index.size(1));
}

bool QueryDecoderImpl::trains_fused(const at::Tensor& latent) const {
  return at::GradMode::is_enabled() && latent.device().is_cpu() &&
         latent.scalar_type() == at::kFloat && (dropout_ == 0 || !is_training()) &&
         fills_table_blocks(layers_);
}

LatentTables QueryDecoderImpl::latent_tables(const at::Tensor& latent) {
  if (!trains_fused(latent)) {
    const auto [keys, values] = keys_and_values(latent);
    return {keys, values};
  }
  return {arranged_table(layers_, latent, /*gap=*/0), {}};
}

at::Tensor QueryDecoderImpl::forward(const at::Tensor& attributes,
                                     const std::vector<SceneQueries>& scenes,
                                     const LatentTables& latents) {
  if (latents.fused()) return forward_fused(attributes, scenes, latents.keys);
  std::vector<at::Tensor> index, geometry;
  int64_t before = 0;  // latents of the scenes before
  for (const SceneQueries& scene : scenes) {
    const Neighbourhood near = neighbourhood(scene.query, scene.anchor, scene.spacing);
    index.push_back(near.index + before);
    geometry.push_back(near.geometry);
    before += scene.anchor.position.size(0);
  }
  return forward(attributes, {at::cat(index), at::cat(geometry)}, latents.keys, latents.values);
}

at::Tensor QueryDecoderImpl::forward_fused(const at::Tensor& attributes,
                                           const std::vector<SceneQueries>& scenes,
                                           const at::Tensor& table) {
  // One scene's offsets are scaled by the operator; several scenes' spacings differ.
  const bool alone = scenes.size() == 1;
  std::vector<int64_t> counts;
  for (const SceneQueries& scene : scenes) counts.push_back(scene.query.position.size(0));
  std::vector<QueryOrder> order;
  std::vector<at::Tensor> input = attributes.split_with_sizes(counts);
  std::vector<at::Tensor> query, anchor, normal, anchor_normal, index;
  int64_t latents = 0;  // of the scenes before
  for (const SceneQueries& scene : scenes) {
    at::Tensor& row = input[order.size()];
    const QueryOrder& along = order.emplace_back(scene.query.position);
    const at::Tensor position = along.ordered(scene.query.position);
    row = along.ordered(row);
    index.push_back(nearest(position, scene.anchor.position) + latents);
    query.push_back(alone ? position : position.div(scene.spacing));
    anchor.push_back(alone ? scene.anchor.position : scene.anchor.position.div(scene.spacing));
    if (reads_normals_) {
      normal.push_back(along.ordered(scene.query.normal));
      anchor_normal.push_back(scene.anchor.normal);
    }
    latents += scene.anchor.position.size(0);
  }
  ops::QueryNeighbourhood near{at::cat(query), at::cat(anchor), at::cat(index),
                               alone ? 1 / scenes[0].spacing : 1.0, kOffsetLimit};
  if (reads_normals_) {
    near.normal = at::cat(normal);
    near.anchor_normal = at::cat(anchor_normal);
  }
  std::vector<at::Tensor> answers =
      ops::query_decoder(at::cat(input), near, table, weights()).split_with_sizes(counts);
  for (size_t i = 0; i < answers.size(); ++i) answers[i] = order[i].restored(answers[i]);
  return at::cat(answers);
}

std::tuple<at::Tensor, at::Tensor> QueryDecoderImpl::neighbour_sums(const Neighbourhood& near,
                                                                    const at::Tensor& keys,
                                                                    const at::Tensor& values) {
  const int64_t Q = near.index.size(0), K = near.index.size(1);
  const int64_t width = std::max(gamma_->hidden()->weight.size(0), keys.size(2));
  const int64_t rows = rows_of_a_block(K * width, keys.device());
  if (Q <= rows) {
    return ops::neighbour_sums(keys, values, gamma_->forward(near.geometry), near.index);
  }
  std::vector<at::Tensor> S1, S2;
  for (int64_t begin = 0; begin < Q; begin += rows) {
    const int64_t count = std::min(rows, Q - begin);
    const at::Tensor geometry = near.geometry.narrow(0, begin, count),
                     index = near.index.narrow(0, begin, count);
    const auto sums = [this, geometry, index](const std::vector<at::Tensor>& table) {
      const auto [s1, s2] =
          ops::neighbour_sums(table[0], table[1], gamma_->forward(geometry), index);
      return std::vector<at::Tensor>{s1, s2};
    };
    const std::vector<at::Tensor> block = recompute(sums, {keys, values}, gamma_->parameters());
    S1.push_back(block[0]);
    S2.push_back(block[1]);
  }
  return {at::cat(S1, 1), at::cat(S2, 1)};
}

ops::DecoderWeights QueryDecoderImpl::weights() const {
  std::vector<ops::LayerWeights> layers;
  for (const QueryLayer& layer : layers_) layers.push_back(layer->weights());
  return {
      point_->weights(), gamma_->weights(), layers, {norm_->weight, norm_->bias}, head_->weights()};
}

std::shared_ptr<const ops::KnnIndex> QueryDecoderImpl::index(const at::Tensor& anchor) const {
  return std::make_shared<const ops::KnnIndex>(anchor, neighbours_);
}

std::shared_ptr<const ops::PackedDecoder> QueryDecoderImpl::packed() const {
  return ops::pack_decoder(weights());
}

at::Tensor QueryDecoderImpl::infer(const at::Tensor& attributes, const Surface& query,
                                   const Surface& anchor, double spacing, const at::Tensor& table,
                                   const Prepared& prepared) {
  if (!is_training()) {  // dropout needs the layers one by one
    const at::Tensor index =
        prepared.nearest != nullptr
            ? std::get<0>(prepared.nearest->search(query.position.to(at::kFloat).contiguous()))
            : nearest(query.position, anchor.position);
    ops::QueryNeighbourhood near{query.position, anchor.position, index, 1 / spacing, kOffsetLimit};
    if (reads_normals_) {
      near.normal = query.normal;
      near.anchor_normal = anchor.normal;
    }
    if (prepared.weights != nullptr)
      return ops::query_decoder_inference(attributes, near, table, *prepared.weights);
    return ops::query_decoder_inference(attributes, near, table, weights());
  }
  const Neighbourhood near = neighbourhood(query, anchor, spacing);
  const at::Tensor hidden = gamma_->hidden_activations(near.geometry);
  const Linear& last = gamma_->output();
  const auto [S1, S2] =
      ops::neighbour_sums_inference(table, hidden, last->weight, last->bias, near.index);
  return run_layers(attributes, S1, S2, near.index.size(1));
}

at::Tensor QueryDecoderImpl::run_layers(const at::Tensor& attributes, const at::Tensor& S1,
                                        const at::Tensor& S2, int64_t neighbours) {
  at::Tensor G = point_->forward(attributes);
  const std::vector<at::Tensor> first = S1.unbind(0), second = S2.unbind(0);
  for (size_t l = 0; l < layers_.size(); ++l) {
    G = layers_[l]->forward(G, first[l], second[l], neighbours);
  }
  return answer(G);
}

DecoderReading QueryDecoderImpl::read(const at::Tensor& attributes, const SceneQueries& queries,
                                      const at::Tensor& latent) {
  const Neighbourhood near = neighbourhood(queries.query, queries.anchor, queries.spacing);
  const at::Tensor place = gamma_->forward(near.geometry);
  const double neighbours = static_cast<double>(near.index.size(1));
  const at::Tensor rows = latent.index_select(0, near.index.reshape({-1}));
  at::Tensor G = point_->forward(attributes);
  std::vector<at::Tensor> weights, values;
  for (QueryLayer& layer : layers_) {
    const auto [key, value] = layer->keys_and_values(rows);
    const at::Tensor relation = layer->query(G).unsqueeze(1) - key.view(place.sizes()) + place;
    weights.push_back(relation.div(neighbours));
    values.push_back(value.view(place.sizes()) + place);
    G = layer->advance(G, (weights.back() * values.back()).sum(1));
  }
  return {near.index, at::stack(weights), at::stack(values), answer(G)};
}

at::Tensor QueryDecoderImpl::answer(const at::Tensor& G) {
  return at::softplus(head_->forward(norm_->forward(G)));
}

}  // namespace lte::nn
