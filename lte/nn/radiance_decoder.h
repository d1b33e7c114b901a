// Radiance decoder (the paper's section 5.3): incident radiance at a surface point from any
// direction, from the latents nearest to the point.
//
// A query decoder of its own gathers what a point needs to know of its surroundings. The direction
// enters late: that happens once, and a head makes functions of direction of it. RadianceHead says
// which:
//
// - Directions: the point's lobes are ridge functions of direction with axes and offsets of their
//   own. A further direction evaluates them and a small perceptron, which with
//   RadianceBase::Points also reads what a ray sees of the scene points.
// - Map: cells of an octahedral map of all directions (Meyer et al. 2010), in one pass.
// - Gaussians: a sum of spherical Gaussians (Wang et al. 2009).
//
// Or early: each direction of a point is a query of its own, that is told the direction and what a
// ray sees of the scene points, and all layers pass for each.
#pragma once

#include <cstdint>

#include "lte/nn/query_decoder.h"

namespace lte::nn {

/// Parameters: `query.*` (QueryDecoder whose head answers D features), and with K = radiance_lobes:
/// of Directions `lobes.*` (D -> 5 K), `mix.*` (K -> K, or K + kSeenFeatures -> K) and `color.*`
/// (K -> 3, or 6); of Map `map.*` (D -> 3 K²); of Gaussians `gaussians.*` (D -> 7 K). Of Early
/// `query.*` alone, whose H reads direction_inputs() more and whose head answers 3, or 6.
class RadianceDecoderImpl : public torch::nn::Module {
 public:
  /// @param latent  width of the latents
  RadianceDecoderImpl(int64_t latent, const ModelConfig& config);

  /// What gathers features: its answers are features of points, [Q, D]; of Early, r and s of each
  /// direction, [Q N, 3 or 6].
  QueryDecoder& query() { return query_; }

  /// π radiance over the emission scale: r(ω) ⊙ light, or where rays were cast
  /// r(ω) ⊙ light + s(ω) ⊙ what the ray sees. Where the point's features give a, b, c and more:
  ///
  /// - Directions: h_k = GELU(a_k · ω + b_k), then r, s = softplus(W_color GELU(W_mix [h, seen] +
  ///   c));
  /// - Map: r = softplus(the cell that ω lies in);
  /// - Gaussians: r = Σ_k softplus(c_k) exp(softplus(b_k) (ω · a_k / |a_k| − 1));
  /// - Early: r and s are what query() answers.
  ///
  /// @param features    what query() answers
  /// @param directions  [Q, N, 3] world, unit, away from the point
  /// @param light       [Q, 3]; undefined: 1
  /// @param seen        [Q, N, kSeenColumns] (lte/nn/surfels.h), of models that cast rays
  /// @return            [Q, N, 3], non-negative, differentiable in features and parameters
  at::Tensor radiance(const at::Tensor& features, const at::Tensor& directions,
                      const at::Tensor& light = {}, const at::Tensor& seen = {});

 private:
  void make_directions(const ModelConfig& config);
  void make_map(const ModelConfig& config);
  void make_gaussians(const ModelConfig& config);
  /// r, or r and s, [Q, N, 3 or 6].
  at::Tensor ask(const at::Tensor& features, const at::Tensor& directions, const at::Tensor& seen);
  at::Tensor ask_directions(const at::Tensor& features, const at::Tensor& directions,
                            const at::Tensor& seen);
  at::Tensor ask_map(const at::Tensor& features, const at::Tensor& directions);
  at::Tensor ask_gaussians(const at::Tensor& features, const at::Tensor& directions);

  RadianceHead kind_;
  int64_t lobes_per_point_;
  QueryDecoder query_{nullptr};
  Linear lobes_{nullptr}, mix_{nullptr}, color_{nullptr}, map_{nullptr}, gaussians_{nullptr};
};
TORCH_MODULE(RadianceDecoder);

/// Columns that the query of an early direction has beyond those of its point.
int64_t direction_inputs(const ModelConfig& config);

/// The cell of an octahedral map of edge × edge cells that each direction lies in, [Q, N] int64.
at::Tensor octahedral_cells(const at::Tensor& directions, int64_t edge);

}  // namespace lte::nn
