// Norms and what follows them in a transformer's block, each one operator, so that training keeps
// no intermediate: the backward pass makes them again, tile by tile, in the caches.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/ops/decoder_weights.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Whether the operators below take `x`: float32 on the CPU.
inline bool suits_norm_layers(const at::Tensor& x) {
  return x.device().is_cpu() && x.scalar_type() == at::kFloat;
}

/// LN(x) over the last axis, of any device and dtype; differentiable.
///
/// @note float32 on the CPU without gradients has the arithmetic of the operators below.
at::Tensor layer_norm(const at::Tensor& x, const NormWeights& norm);

/// W LN(x) + b.
///
/// @param x       [n, C] float32 on the CPU
/// @param linear  float32, or bfloat16 where no gradient is asked; may have a rounding, by which
///                mixed precision rounds x and gradients too as products read them
/// @return        [n, O]; differentiable once in x and all weights
/// @throws c10::Error on a wrong shape, dtype or device
/// @note The same bits for any number of threads, gradients included.
at::Tensor norm_linear(const at::Tensor& x, const NormWeights& norm, const LinearWeights& linear);

/// h + W2 GELU(W1 LN(h) + b1) + b2, where h = x + W a + b, W and b those of `projection`; otherwise
/// as norm_linear().
///
/// @param attended  a, [n, inputs of the projection] float32 on the CPU
at::Tensor project_feed_forward(const at::Tensor& x, const at::Tensor& attended,
                                const LinearWeights& projection, const NormWeights& norm,
                                const PerceptronWeights& perceptron);

/// LayerNorm of what is left when a share of each channel's mean over a scene's points has been
/// subtracted.
struct CenteredNorm {
  NormWeights norm;
  at::Tensor share;  ///< [C]; undefined: plain LayerNorm
};

/// N(W x + b), or r + N(W x + b), otherwise as norm_linear().
///
/// @param residual  r, [n, C] float32 on the CPU, or undefined
/// @param counts    rows of each scene, one after the other; n in all
/// @throws c10::Error also if the counts do not add up to n
at::Tensor linear_norm(const at::Tensor& x, const LinearWeights& linear, const CenteredNorm& norm,
                       const std::vector<int64_t>& counts, const at::Tensor& residual = {});

}  // namespace lte::ops
