// Nearest-neighbour embedding (the paper's section 3.3, equations 1 to 3): M raw points -> m = M/4
// features.
#pragma once

#include <cstdint>

#include "lte/nn/blocks/mlp.h"
#include "lte/nn/encoder/encoder_plan.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// max over k of G(concat(X_k − X̃_l, X̃_l)), G a perceptron 2D -> D -> D.
///
/// G's first layer is linear, so it is applied to points instead of pairs: W concat(X_k − X̃_l,
/// X̃_l) = W_a X_k + (W_b − W_a) X̃_l with W = [W_a | W_b]. Only its activation and the second
/// layer see pairs. Parameters: those of Mlp; `hidden.weight` is [D, 2D].
class NeighbourMaxImpl : public torch::nn::Module {
 public:
  explicit NeighbourMaxImpl(int64_t channels);

  /// @param dense      [n, D] features of the denser set
  /// @param center     [m, D] features of the sparser set
  /// @param neighbour  [m, k] int64 into `dense`
  /// @return           [m, D]
  /// @note No [m, k, D] tensor exists where that is large: on the CPU in float32 all is one
  /// operator; else it works through the centres in blocks, which training recomputes.
  at::Tensor forward(const at::Tensor& dense, const at::Tensor& center,
                     const at::Tensor& neighbour);

 private:
  /// Whether ops::neighbour_max() trains what follows the first layer.
  bool fuses(const at::Tensor& projected) const;

  Linear hidden_{nullptr}, output_{nullptr};
};
TORCH_MODULE(NeighbourMax);

/// F, then two halvings. Parameters: `point.*` (F, inputs -> D -> D), `first.*` and `second.*` (G
/// of either halving).
class NearestNeighbourEmbeddingImpl : public torch::nn::Module {
 public:
  /// @param inputs  attributes of a point, ModelConfig::point_inputs()
  NearestNeighbourEmbeddingImpl(int64_t inputs, int64_t channels);

  /// @param attributes  [M, inputs]: position, normal, albedo, compressed emission, and compressed
  ///                    irradiance, direct and indirect, where the model reads it
  /// @return            [m, D]
  at::Tensor forward(const at::Tensor& attributes, const EncoderPlan& plan);

 private:
  Mlp point_{nullptr};
  NeighbourMax first_{nullptr}, second_{nullptr};
};
TORCH_MODULE(NearestNeighbourEmbedding);

}  // namespace lte::nn
