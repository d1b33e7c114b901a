// torch::nn::Linear on lte::ops::linear: the same parameters, names and first values.
#pragma once

#include <algorithm>

#include <ATen/core/grad_mode.h>
#include <torch/nn/modules/linear.h>

#include "lte/nn/precision.h"
#include "lte/ops/linear.h"

namespace lte::nn {

/// Parameters: `weight` [out, in], `bias` [out] (checkpoint names; do not rename).
class LinearImpl : public torch::nn::LinearImpl {
 public:
  using torch::nn::LinearImpl::LinearImpl;

  /// @param x  [..., in]
  /// @return   [..., out]
  at::Tensor forward(const at::Tensor& x) { return ops::linear(x, inference_weight(), bias); }

  /// Of products without gradients from now on. Layers of few inputs or outputs stay in float32:
  /// they read positions and colours, or answer, and cost nothing.
  /// @note Rounds the weights that there are now.
  void set_precision(Precision precision) {
    const bool narrow = std::min(options.in_features(), options.out_features()) < kLeastRounded;
    rounded_ =
        precision == Precision::Bf16 && !narrow ? weight.detach().to(at::kBFloat16) : at::Tensor();
  }

  bool in_bf16() const { return rounded_.defined() && !at::GradMode::is_enabled(); }
  /// What a product reads: the parameter, or where no gradient is asked, its rounding.
  const at::Tensor& inference_weight() const { return in_bf16() ? rounded_ : weight; }

 private:
  static constexpr int64_t kLeastRounded = 16;
  at::Tensor rounded_;  ///< undefined in float32
};
TORCH_MODULE(Linear);

}  // namespace lte::nn
