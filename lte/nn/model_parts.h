// The modules of the network and how queries are put to its decoders: what model.cpp and
// model_radiance.cpp share.
#pragma once

#include <vector>

#include "lte/nn/constants.h"
#include "lte/nn/decoder/query_decoder.h"
#include "lte/nn/decoder/query_order.h"
#include "lte/nn/decoder/radiance_decoder.h"
#include "lte/nn/encoder/nearest_neighbour_embedding.h"
#include "lte/nn/encoder/point_transformer.h"
#include "lte/nn/model.h"
#include "lte/ops/query_decoder.h"
#include "lte/tensor/functions.h"

namespace lte::nn {

/// Queries decoded at a time. By the fused operator their neighbours are all that is kept, 50 MB;
/// else the intermediates are some 60 MB at D = 128 and stay in the outer caches' reach.
inline constexpr int64_t kTableBlock = int64_t{1} << 17, kQueryBlock = 4096;

inline at::Tensor surface_attributes(const at::Tensor& position, const at::Tensor& normal,
                                     const at::Tensor& albedo) {
  const at::Tensor p = position.clamp(-kPositionLimit, kPositionLimit).mul(kPositionGain);
  return at::cat({p, normal, albedo}, 1);
}

/// Multiplies the channels, which are the last axis, by the scene's scales and by `factor`. By
/// number: a tensor's way to a GPU would be waited for.
inline void scale_channels(const at::Tensor& emission_scale, double factor, at::Tensor* out) {
  const auto scale = emission_scale.accessor<double, 1>();
  for (int64_t c = 0; c < 3; ++c) out->select(-1, c).mul_(scale[c] * factor);
}

/// Whether nothing in the scene shines. Light is linear: then there is none, whatever the network
/// would say.
inline bool is_dark(const at::Tensor& emission_scale) {
  const auto scale = emission_scale.accessor<double, 1>();
  return !(scale[0] > 0) && !(scale[1] > 0) && !(scale[2] > 0);
}

struct LightTransportModelImpl::Parts {
  NearestNeighbourEmbedding nne{nullptr};
  PointTransformer encoder{nullptr};
  QueryDecoder decoder{nullptr};
  RadianceDecoder radiance{nullptr};  ///< null where the model has none

  /// The input of a decoder for queries of one scene, and the light that its answer is a factor on,
  /// if it is one.
  struct Input {
    at::Tensor attributes, light;
    SceneQueries queries;
  };
  static Input input_of(const Embedding& embedding, const QuerySet& queries) {
    Input input;
    const at::Tensor position = (queries.position - embedding.origin).div(embedding.scale);
    input.attributes = surface_attributes(position, queries.normal, queries.albedo);
    input.queries = {
        {position, queries.normal}, {embedding.position, embedding.normal}, embedding.spacing};
    if (embedding.prior.defined()) {
      const LightReading reading = embedding.prior.read(position, queries.normal);
      input.attributes = at::cat({input.attributes, reading.features}, 1);
      input.light = reading.irradiance;
    }
    return input;
  }

  /// [Q, 3] over the emission scale, from the embedding's table.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries) {
    const Input input = input_of(embedding, queries);
    const at::Tensor answer = decoder->infer(
        input.attributes, input.queries.query, input.queries.anchor, embedding.spacing,
        embedding.table, {embedding.nearest.get(), embedding.weights.get()});
    return input.light.defined() ? input.light * answer : answer;
  }

  /// The input of a decoder for the queries of several scenes, one after the other.
  struct BatchInput {
    at::Tensor attributes;
    std::vector<at::Tensor> light;  ///< of each scene; empty where answers are no factors
    std::vector<SceneQueries> queries;
    std::vector<int64_t> counts;
  };
  static BatchInput joined(const std::vector<Input>& scenes) {
    BatchInput all;
    std::vector<at::Tensor> attributes;
    for (const Input& input : scenes) {
      attributes.push_back(input.attributes);
      all.queries.push_back(input.queries);
      if (input.light.defined()) all.light.push_back(input.light);
      all.counts.push_back(input.attributes.size(0));
    }
    all.attributes = at::cat(attributes);
    return all;
  }

  /// decode(), differentiable, for each of some scenes, the decoder run once for the queries of all
  /// of them.
  std::vector<at::Tensor> decode(const std::vector<Embedding>& scenes,
                                 const std::vector<QuerySet>& queries,
                                 const LatentTables& latents) {
    std::vector<Input> each;
    for (size_t i = 0; i < queries.size(); ++i) each.push_back(input_of(scenes[i], queries[i]));
    const BatchInput input = joined(each);
    at::Tensor answer = decoder->forward(input.attributes, input.queries, latents);
    if (!input.light.empty()) answer = answer * at::cat(input.light);
    return answer.split_with_sizes(input.counts);
  }

  /// decode() from the table in a QueryOrder.
  at::Tensor decode_ordered(const Embedding& embedding, const QuerySet& queries) {
    const QueryOrder order(queries.position);
    return order.restored(decode(embedding, order.ordered(queries)));
  }
};

}  // namespace lte::nn
