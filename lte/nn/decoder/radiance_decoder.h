// Radiance decoder (the paper's section 5.3): incident radiance at a surface point from any
// direction, from the latents nearest to the point.
//
// A query decoder of its own gathers what a point needs to know of its surroundings, once for all
// directions. A head makes lobes of it: ridge functions of direction with axes and offsets of their
// own. Each direction evaluates them, and a small perceptron mixes them with what a ray sees of the
// scene points.
#pragma once

#include <cstdint>

#include "lte/nn/decoder/query_decoder.h"

namespace lte::nn {

/// Parameters: `query.*` (QueryDecoder whose head answers D features), and with K = radiance_lobes
/// `lobes.*` (D -> 5 K), `mix.*` (K + kSeenFeatures -> K) and `color.*` (K -> 6).
class RadianceDecoderImpl : public torch::nn::Module {
 public:
  /// @param latent  width of the latents
  RadianceDecoderImpl(int64_t latent, const ModelConfig& config);

  /// Gathers the features of points, [Q, D].
  QueryDecoder& query() { return query_; }

  /// π radiance over the emission scale: r(ω) ⊙ light + s(ω) ⊙ what the ray sees. The features of a
  /// point give a, b and c of its lobes: h_k = GELU(a_k · ω + b_k), then
  /// r, s = softplus(W_color GELU(W_mix [h, seen] + c)).
  ///
  /// @param features    of query()
  /// @param directions  [Q, N, 3] world, unit, away from the point
  /// @param light       [Q, 3]
  /// @param seen        [Q, N, kSeenColumns] (lte/nn/points/surfels.h)
  /// @return            [Q, N, 3], non-negative, differentiable in features and parameters
  at::Tensor radiance(const at::Tensor& features, const at::Tensor& directions,
                      const at::Tensor& light, const at::Tensor& seen);

 private:
  int64_t lobes_per_point_;
  QueryDecoder query_{nullptr};
  Linear lobes_{nullptr}, mix_{nullptr}, color_{nullptr};
};
TORCH_MODULE(RadianceDecoder);

}  // namespace lte::nn
