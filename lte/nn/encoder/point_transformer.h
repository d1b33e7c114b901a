// Point Transformer V3 as the paper's light transport encoder uses it (section 3.3): a U-Net of
// transformer blocks over grids that halve their resolution, from m features back to m latents.
#pragma once

#include <vector>

#include "lte/nn/encoder/pooling.h"
#include "lte/nn/encoder/transformer_block.h"

namespace lte::nn {

/// The blocks of one stage on the way down or up. Parameters: `I.*` for block I.
class StageImpl : public torch::nn::Module {
 public:
  StageImpl(int64_t depth, int64_t channels, const ModelConfig& config);

  /// @param recorder  receives each block's attention; may be null
  at::Tensor forward(at::Tensor x, const StagePlan& plan, EncoderRecorder* recorder);

 private:
  std::vector<TransformerBlock> blocks_;
};
TORCH_MODULE(Stage);

/// Parameters: `stem.*`, `stem_norm.*`, `downS.*` (stage S of the encoder), `poolS.*` (into stage S
/// >= 1), `unpoolS.*` and `upS.*` (back at stage S), `norm.*`.
class PointTransformerImpl : public torch::nn::Module {
 public:
  explicit PointTransformerImpl(const ModelConfig& config);

  /// @param x         [m, D]
  /// @param recorder  receives all blocks and stages; may be null
  /// @return          [m, latent_width()] (lte/nn/cost.h)
  at::Tensor forward(const at::Tensor& x, const EncoderPlan& plan,
                     EncoderRecorder* recorder = nullptr);

 private:
  SubmanifoldConv stem_{nullptr};
  PointNorm stem_norm_{nullptr};
  LayerNorm norm_{nullptr};
  std::vector<Stage> down_, up_;
  std::vector<Pooling> pool_;      ///< pool_[s] leads from stage s to s + 1
  std::vector<Unpooling> unpool_;  ///< unpool_[s] leads from stage s + 1 to s
};
TORCH_MODULE(PointTransformer);

}  // namespace lte::nn
