// torch::nn::Linear on lte::ops::linear: the same parameters, names and first values.
#pragma once

#include "lte/nn/blocks/precision.h"
#include "lte/nn/blocks/recompute.h"
#include "lte/ops/decoder_weights.h"
#include "lte/ops/linear.h"
#include "lte/tensor/module.h"

namespace lte::nn {

/// Parameters: `weight` [out, in], `bias` [out] (names in model files; do not rename).
class LinearImpl : public torch::nn::LinearImpl {
 public:
  using torch::nn::LinearImpl::LinearImpl;

  /// @param x  [..., in]
  /// @return   [..., out]
  at::Tensor forward(const at::Tensor& x) {
    return in_autocast() ? ops::linear_autocast(x, weight, bias)
                         : ops::linear(x, inference_weight(), bias);
  }
  /// The same with other weights, in this layer's precision. For callers that take the matrix
  /// apart.
  at::Tensor product(const at::Tensor& x, const at::Tensor& w, const at::Tensor& b = {}) const {
    return in_autocast() ? ops::linear_autocast(x, w, b)
                         : ops::linear(x, in_bf16() ? w.to(at::kBFloat16) : w, b);
  }

  /// Sets the arithmetic of products without gradients from now on. Layers whose inputs or outputs
  /// are no multiple of 16 stay in float32: they read positions, colors and light, or answer, and
  /// cost nothing.
  /// @note Rounds the weights that there are now.
  void set_precision(Precision precision) {
    rounded_ = precision == Precision::Bf16 && !reads_or_answers()
                   ? weight.detach().to(at::kBFloat16)
                   : at::Tensor();
  }
  /// Sets the arithmetic of products that are differentiated from now on: Bf16 is
  /// ops::linear_autocast(), for the same layers.
  void set_autocast(Precision precision) {
    autocast_ = precision == Precision::Bf16 && !reads_or_answers();
  }
  /// Keeps this layer in float32 too, however many inputs it has: for one that reads positions.
  void keep_float32() { kept_ = true; }

  /// The layer as fused operators read it, in training and inference.
  ops::LinearWeights weights() const {
    return {inference_weight(), bias,
            in_autocast() ? weight.detach().to(at::kBFloat16) : at::Tensor()};
  }

  bool in_autocast() const { return autocast_ && is_differentiated(); }
  bool in_bf16() const { return rounded_.defined() && !is_differentiated(); }
  /// What a product reads: the parameter, or where no gradient is asked, its rounding.
  const at::Tensor& inference_weight() const { return in_bf16() ? rounded_ : weight; }

 private:
  static constexpr int64_t kRoundedBlock = 16;
  bool reads_or_answers() const {
    return kept_ || options.in_features() % kRoundedBlock != 0 ||
           options.out_features() % kRoundedBlock != 0;
  }

  at::Tensor rounded_;  ///< undefined in float32
  bool autocast_ = false, kept_ = false;
};
TORCH_MODULE(Linear);

}  // namespace lte::nn
