// What weighs what in a network's attention, for looking inside. Nothing records unless it is
// asked to, and what is recorded changes no answer by a bit: a block's queries, keys and values are
// computed once more, beside the pass that answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lte/nn/encoder/encoder_plan.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// The attention of one block of the encoder over one scene. Any row of it can be asked for, as all
/// of them would take n² numbers a head.
struct BlockAttention {
  std::string name;  ///< as in the names of parameters: "down3.2"
  size_t level = 0;  ///< its resolution: index into EncoderPlan::stages
  int64_t heads = 1;
  at::Tensor qkv;  ///< [n, 3C] queries, keys and values as products read them
  PatchMap patch;
  int64_t patch_size = 0;  ///< not read where `patch` is of all points

  int64_t points() const { return qkv.size(0); }
  /// By how much a point takes the value of each other, [heads, n]: rows that sum to one, 0 for
  /// points outside its patch.
  at::Tensor weights(int64_t point) const;
  /// Entropy of the rows over the logarithm of the points of a patch; a mean over heads and points,
  /// NaN for patches of one point. 1: every point takes the plain mean of all.
  double entropy() const;
};

/// Of a pass of one scene through the encoder.
struct EncoderAttention {
  std::vector<BlockAttention> blocks;  ///< in the order of the network
  /// By level, [m] int64: the point of that resolution that each latent is part of.
  std::vector<at::Tensor> point_of_latent;
  at::Tensor scene_point;  ///< [m] int64: the scene point at which each latent lies
  at::Tensor normal;       ///< [m, 3] of those

  /// BlockAttention::weights() of the point that a latent is part of.
  at::Tensor weights(size_t block, int64_t latent) const;
};

/// Receives a pass of one scene through the encoder as it happens.
class EncoderRecorder {
 public:
  virtual ~EncoderRecorder() = default;
  virtual void plan(const EncoderPlan& /*plan*/) {}
  /// A block of the stage that is recorded next.
  virtual void block(BlockAttention attention) = 0;
  /// Features [n, C] leave a stage.
  /// @param name   as in the names of parameters: "stem", "down0", ..., "up0"
  /// @param level  its resolution
  virtual void stage(const std::string& name, size_t level, const at::Tensor& features) = 0;
};

/// Keeps all of it, for as long as `record` lives: [n, 3C] a block.
class AttentionRecorder : public EncoderRecorder {
 public:
  explicit AttentionRecorder(EncoderAttention* record) : record_(record) {}
  void plan(const EncoderPlan& plan) override;
  void block(BlockAttention attention) override;
  void stage(const std::string& name, size_t level, const at::Tensor& features) override;

 private:
  EncoderAttention* record_;
  size_t named_ = 0;  ///< blocks of stages that are over
};

/// What the query decoder's layers took from which latent.
struct DecoderReading {
  at::Tensor index;  ///< [Q, κ] int64, the latents near each query, nearest first
  /// [L, Q, κ, D], by layer: the weight of each neighbour in each channel, (W_q G − k + P) / κ,
  /// which may be negative and adds up to nothing in particular.
  at::Tensor weights;
  at::Tensor values;  ///< [L, Q, κ, D], v + P: Σ weight ⊙ value is what a layer attends to
  at::Tensor answer;  ///< [Q, 3], what the layers come to, as decode_normalized() has it

  /// How much each neighbour counts, [L, Q, κ]: the mean over channels of the weights' magnitude,
  /// over its sum over the neighbours. Rows sum to one.
  at::Tensor shares() const;
};

}  // namespace lte::nn
