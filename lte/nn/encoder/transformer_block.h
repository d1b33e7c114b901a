// PTV3's parts: patch attention, sparse convolution, centering norm and the block of all three.
#pragma once

#include <cstdint>

#include "lte/nn/blocks/layer_norm.h"
#include "lte/nn/blocks/linear.h"
#include "lte/nn/blocks/mlp.h"
#include "lte/nn/encoder/attention_record.h"
#include "lte/nn/encoder/encoder_plan.h"
#include "lte/tensor/module.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// Multi-head attention within patches of consecutive points along a curve; over all points if
/// there is one patch. Parameters: `qkv.{weight,bias}` (rows: q, k, v; within each heads, then
/// channels of a head), `proj.{weight,bias}`.
class PatchAttentionImpl : public torch::nn::Module {
 public:
  PatchAttentionImpl(int64_t channels, int64_t heads, double dropout);

  /// Points attend to those of their own scene alone.
  ///
  /// @param x      [n, C]
  /// @param stage  its scenes, and the angles, if there are any, that turn queries and keys
  /// @param order  which of the patch maps to use, modulo their number
  /// @return       [n, C]
  at::Tensor forward(const at::Tensor& x, const StagePlan& stage, size_t order, int64_t patch_size);

  /// forward() of norm(x); on the CPU norm and first layer are one operator, unless the
  /// points are few and nothing is differentiated.
  at::Tensor forward(const at::Tensor& x, LayerNorm& norm, const StagePlan& stage, size_t order,
                     int64_t patch_size);
  /// The same before the last layer, `proj`.
  at::Tensor attended(const at::Tensor& x, LayerNorm& norm, const StagePlan& stage, size_t order,
                      int64_t patch_size);

  /// What forward() would weigh values by, without name and level.
  /// @param stage  of one scene
  BlockAttention record(const at::Tensor& x, const StagePlan& stage, size_t order,
                        int64_t patch_size);

  ops::LinearWeights projection() const { return proj_->weights(); }

 private:
  /// What the points of one scene attend to.
  /// @param qkv  [n, 3C] of the scene
  at::Tensor attend(const at::Tensor& qkv, const PatchMap& map, int64_t patch_size);
  at::Tensor project(const at::Tensor& attended);
  /// What project() takes, from queries, keys and values.
  at::Tensor attend_in_scenes(const at::Tensor& qkv, const StagePlan& stage, size_t order,
                              int64_t patch_size);
  /// Queries, keys and values of the points, with the first two turned.
  at::Tensor turned(const at::Tensor& qkv, const StagePlan& stage);

  int64_t heads_;
  double dropout_;
  Linear qkv_{nullptr}, proj_{nullptr};
};
TORCH_MODULE(PatchAttention);

/// ops::submanifold_conv with its parameters: `weight` [taps, Cin, Cout] and, if asked for, `bias`
/// [Cout].
class SubmanifoldConvImpl : public torch::nn::Module {
 public:
  SubmanifoldConvImpl(int64_t kernel, int64_t inputs, int64_t outputs, bool with_bias);

  at::Tensor forward(const at::Tensor& x, const at::Tensor& pairs, const at::Tensor& tap_begin);

  /// As Linear's; widths that are not whole blocks stay in float32.
  void set_precision(Precision precision);
  void set_autocast(Precision precision) { autocast_ = precision == Precision::Bf16; }

 private:
  at::Tensor weight_, bias_;
  at::Tensor rounded_;  ///< undefined in float32
  bool autocast_ = false;
};
TORCH_MODULE(SubmanifoldConv);

/// LayerNorm of what is left when a learnt share of each channel's mean over the points has been
/// subtracted: what all points have in common says nothing about any of them, and LayerNorm alone,
/// which sees one point at a time, cannot remove it. Plain LayerNorm if it does not center.
/// Parameters: `weight`, `bias` [C], as LayerNorm's, and where it centers `share` [C], at first 1.
class PointNormImpl : public torch::nn::Module {
 public:
  PointNormImpl(int64_t channels, bool centers);

  /// @param x      [n, C]
  /// @param stage  whose scenes the means are over
  /// @return       [n, C]
  at::Tensor forward(const at::Tensor& x, const StagePlan& stage);
  /// forward() of linear(x), or residual + that; on the CPU one operator, unless the points are few
  /// and nothing is differentiated.
  at::Tensor after(Linear& linear, const at::Tensor& x, const StagePlan& stage,
                   const at::Tensor& residual = {});

 private:
  at::Tensor weight_, bias_;
  at::Tensor share_;  ///< undefined without centering
};
TORCH_MODULE(PointNorm);

/// x += PN(Linear(conv(x))); x += Attention(LN(x)); x += MLP(LN(x)), PN the PointNorm.
/// Parameters: `conv.*`, `conv_linear.*`, `conv_norm.*`, `norm1.*`, `attention.*`, `norm2.*`,
/// `mlp.*`.
class TransformerBlockImpl : public torch::nn::Module {
 public:
  TransformerBlockImpl(int64_t channels, const ModelConfig& config);

  /// @param order  which of the stage's patch maps to use, modulo their number
  at::Tensor forward(const at::Tensor& input, const StagePlan& stage, size_t order);

  /// PatchAttention::record() of what forward() would attend to.
  BlockAttention record_attention(const at::Tensor& input, const StagePlan& stage, size_t order);

 private:
  at::Tensor convolve(const at::Tensor& input, const StagePlan& stage);

  int64_t patch_size_;
  SubmanifoldConv conv_{nullptr};
  Linear conv_linear_{nullptr};
  PointNorm conv_norm_{nullptr};
  LayerNorm norm1_{nullptr}, norm2_{nullptr};
  PatchAttention attention_{nullptr};
  Mlp mlp_{nullptr};
};
TORCH_MODULE(TransformerBlock);

}  // namespace lte::nn
