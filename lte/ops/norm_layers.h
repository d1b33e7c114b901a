// Norms and what follows them in a transformer's block, each one operator, so that training keeps
// no intermediate: the backward pass makes them again, tile by tile, in the caches.
#pragma once

#include <ATen/core/Tensor.h>

#include "lte/ops/decoder_weights.h"

namespace lte::ops {

/// Whether the operators below take `x`: float32 on the CPU.
inline bool suits_norm_layers(const at::Tensor& x) {
  return x.device().is_cpu() && x.scalar_type() == at::kFloat;
}

/// W LN(x) + b.
///
/// @param x       [n, C] float32 on the CPU
/// @param linear  float32, or bfloat16 where no gradient is asked; may have a rounding, by which
///                mixed precision rounds x and gradients too as products read them
/// @return        [n, O]; differentiable once in x and all weights
/// @throws c10::Error on a wrong shape, dtype or device
/// @note The same bits for any number of threads, gradients included.
at::Tensor norm_linear(const at::Tensor& x, const NormWeights& norm, const LinearWeights& linear);

/// x + W2 GELU(W1 LN(x) + b1) + b2, otherwise as norm_linear().
at::Tensor feed_forward(const at::Tensor& x, const NormWeights& norm,
                        const PerceptronWeights& perceptron);

/// feed_forward() of x + W a + b, W and b those of `projection`. Not differentiable.
///
/// @param attended  a, [n, inputs of the projection] float32 on the CPU
at::Tensor project_feed_forward(const at::Tensor& x, const at::Tensor& attended,
                                const LinearWeights& projection, const NormWeights& norm,
                                const PerceptronWeights& perceptron);

}  // namespace lte::ops
