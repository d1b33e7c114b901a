// Radiance decoder (the paper's section 5.3): incident radiance at a surface point from any
// direction, from the latents nearest to the point.
//
// The direction enters late. A query decoder of its own gathers what a point needs to know of its
// surroundings, once; of that the point's lobes are made, functions of direction with axes and
// offsets of their own. A further direction evaluates them and a small perceptron.
#pragma once

#include <cstdint>

#include "lte/nn/query_decoder.h"

namespace lte::nn {

/// Parameters: `query.*` (QueryDecoder whose head answers D features), `lobes.*` (D -> 5 K),
/// `mix.*` (K -> K), `color.*` (K -> 3), with K lobes.
class RadianceDecoderImpl : public torch::nn::Module {
 public:
  /// @param latent  width of the latents
  RadianceDecoderImpl(int64_t latent, const ModelConfig& config);

  /// What gathers features: its answers are features of points, [Q, D].
  QueryDecoder& query() { return query_; }

  /// h_k = GELU(a_k · ω + b_k), then softplus(W_color GELU(W_mix h + c)) where the point's features
  /// give a, b and c.
  ///
  /// @param features    [Q, D] of each point
  /// @param directions  [Q, N, 3] world, unit, away from the point
  /// @return            [Q, N, 3], non-negative, differentiable in features and parameters
  at::Tensor radiance(const at::Tensor& features, const at::Tensor& directions);

 private:
  int64_t lobes_per_point_;
  QueryDecoder query_{nullptr};
  Linear lobes_{nullptr}, mix_{nullptr}, color_{nullptr};
};
TORCH_MODULE(RadianceDecoder);

}  // namespace lte::nn
