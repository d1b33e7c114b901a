// PTV3's grid pooling and unpooling: from a stage to the next coarser one and back.
#pragma once

#include <cstdint>

#include "lte/nn/blocks/linear.h"
#include "lte/nn/encoder/encoder_plan.h"
#include "lte/nn/encoder/transformer_block.h"
#include "lte/tensor/module.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// Each cluster's maximum by channel, [clusters, C]; NaN where one of its rows has that.
at::Tensor cluster_max(const at::Tensor& x, const at::Tensor& cluster, int64_t clusters);
/// Row of each cluster's maximum by channel, [clusters, C] int64; ties go to the lowest row.
at::Tensor cluster_argmax(const at::Tensor& x, const at::Tensor& cluster, int64_t clusters);

/// Linear, maximum over the members of each cluster, PN, GELU. Parameters: `linear.*`, `norm.*`.
class PoolingImpl : public torch::nn::Module {
 public:
  PoolingImpl(int64_t inputs, int64_t outputs, bool centers);

  /// @param fine   [n, Cin]
  /// @param stage  the coarser one, whose clusters n points fall into
  /// @return       [stage.points(), Cout]
  at::Tensor forward(const at::Tensor& fine, const StagePlan& stage);

 private:
  Linear linear_{nullptr};
  PointNorm norm_{nullptr};
};
TORCH_MODULE(Pooling);

/// GELU(PN(Linear(coarse)))[cluster] + GELU(PN(Linear(skip))).
/// Parameters: `coarse.*`, `coarse_norm.*`, `skip.*`, `skip_norm.*`.
class UnpoolingImpl : public torch::nn::Module {
 public:
  UnpoolingImpl(int64_t coarse, int64_t skip, int64_t outputs, bool centers);

  /// @param below  the stage that `coarse` has the points of
  /// @param stage  the one that `skip` has the points of
  at::Tensor forward(const at::Tensor& coarse, const at::Tensor& skip, const StagePlan& below,
                     const StagePlan& stage);

 private:
  Linear coarse_{nullptr}, skip_{nullptr};
  PointNorm coarse_norm_{nullptr}, skip_norm_{nullptr};
};
TORCH_MODULE(Unpooling);

}  // namespace lte::nn
