// torch::nn::LayerNorm over the last axis, on lte::ops::layer_norm.
#pragma once

#include <cstdint>

#include "lte/nn/constants.h"
#include "lte/ops/norm_layers.h"
#include "lte/tensor/module.h"

namespace lte::nn {

/// Parameters: `weight`, `bias` [channels] (names in model files; do not rename).
class LayerNormImpl : public torch::nn::LayerNormImpl {
 public:
  explicit LayerNormImpl(int64_t channels)
      : torch::nn::LayerNormImpl(torch::nn::LayerNormOptions({channels}).eps(kNormEpsilon)) {}

  at::Tensor forward(const at::Tensor& x) { return ops::layer_norm(x, {weight, bias}); }
};
TORCH_MODULE(LayerNorm);

}  // namespace lte::nn
