// The three networks of the paper's roadmap (figure 11): a global transformer over the scene points
// with features averaged around a query; the same average of the latents of the light transport
// encoder; and the whole network.
#pragma once

#include <cstdint>
#include <vector>

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include "lte/base/enum_names.h"
#include "lte/nn/blocks/layer_norm.h"
#include "lte/nn/blocks/linear.h"
#include "lte/nn/blocks/mlp.h"
#include "lte/nn/model.h"

namespace lte::experiments {

enum class RoadmapNetwork { Vanilla, Encoder, Whole };

constexpr EnumNames<RoadmapNetwork, 3> enum_names(RoadmapNetwork) {
  return {{{RoadmapNetwork::Vanilla, "vanilla"},
           {RoadmapNetwork::Encoder, "encoder"},
           {RoadmapNetwork::Whole, "whole"}}};
}

/// How attention over all tokens is computed: Fused keeps no [N, N] matrix, Stored keeps one a head
/// and layer for the backward pass, as networks did before fused kernels.
enum class Attention { Fused, Stored };

/// Attention of all tokens to all of `context`, or to one another.
/// Parameters: `query.*`, `key_value.*`, `output.*`.
class GlobalAttentionImpl : public torch::nn::Module {
 public:
  GlobalAttentionImpl(int64_t channels, int64_t heads, Attention attention);

  /// @param x        [N, C], or [B, N, C] of sets that do not see one another
  /// @param context  [n, C], or [B, n, C]
  /// @return         as x
  at::Tensor forward(const at::Tensor& x, const at::Tensor& context);

 private:
  int64_t heads_;
  Attention attention_;
  nn::Linear query_{nullptr}, key_value_{nullptr}, output_{nullptr};
};
TORCH_MODULE(GlobalAttention);

/// x += Attention(LN(x)); x += MLP(LN(x)). Parameters: `norm1.*`, `attention.*`, `norm2.*`, `mlp.*`
class GlobalBlockImpl : public torch::nn::Module {
 public:
  GlobalBlockImpl(int64_t channels, int64_t heads, Attention attention);
  at::Tensor forward(const at::Tensor& x);

 private:
  nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
  GlobalAttention attention_{nullptr};
  nn::Mlp mlp_{nullptr};
};
TORCH_MODULE(GlobalBlock);

/// The mean of the κ features nearest to a query, beside an embedding of the query, through a
/// perceptron: no weight hangs on where a feature lies. Parameters: `point.*`, `head.*`.
class NeighbourMeanImpl : public torch::nn::Module {
 public:
  /// @param features  channels of a feature
  NeighbourMeanImpl(int64_t features, const nn::ModelConfig& config);

  /// @param attributes  [Q, 9] of the queries, as the query decoder's
  /// @param position    [Q, 3] network space, as `anchor` [m, 3]
  /// @param features    [m, features]
  /// @return            [Q, 3], non-negative
  at::Tensor forward(const at::Tensor& attributes, const at::Tensor& position,
                     const at::Tensor& anchor, const at::Tensor& features);

 private:
  int64_t neighbours_;
  nn::Mlp point_{nullptr}, head_{nullptr};
};
TORCH_MODULE(NeighbourMean);

/// Parameters: those of the parts that the network has: `point.*`, `block<I>.*` and `norm.*` of the
/// vanilla transformer, `model.*` of the others, `pool.*` of all but the whole network.
class RoadmapModelImpl : public torch::nn::Module {
 public:
  /// Layers of the vanilla transformer: as many as the paper's encoder has blocks on its way down.
  static constexpr int64_t kVanillaLayers = 14;

  /// @param config  of the whole network; the vanilla one takes its channels, heads and κ
  RoadmapModelImpl(RoadmapNetwork network, const nn::ModelConfig& config,
                   Attention attention = Attention::Fused);

  /// Some scenes in one pass, in which none sees another.
  /// @param order_seeds  of the encoder's curves in training, one a scene
  /// @return  of each scene [Q, 3] irradiance over the emission scale
  std::vector<at::Tensor> forward(const std::vector<nn::PointSet>& points,
                                  const std::vector<nn::QuerySet>& queries,
                                  const std::vector<uint64_t>& order_seeds);

 private:
  /// Features of a scene's latents, and where these lie.
  struct Latents {
    at::Tensor origin, position, features;
  };
  std::vector<Latents> vanilla(const std::vector<nn::PointSet>& points);

  RoadmapNetwork network_;
  nn::ModelConfig config_;
  nn::Mlp point_{nullptr};
  std::vector<GlobalBlock> blocks_;
  nn::LayerNorm norm_{nullptr};
  nn::LightTransportModel model_{nullptr};
  NeighbourMean pool_{nullptr};
};
TORCH_MODULE(RoadmapModel);

}  // namespace lte::experiments
