// The second half of the nearest-neighbour embedding's G: GELU, dense layer, maximum over the
// neighbours (the paper's equations 2 and 3). No tensor of pairs is ever in memory.
#pragma once

#include "lte/ops/decoder_weights.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// What the channels of neighbour_max() are a multiple of.
inline constexpr int64_t kMaximumBlock = 16;

/// The maximum over k of W GELU(dense[neighbour[l][k]] + center[l]) + b.
///
/// @param dense      [n, C] float32
/// @param center     [m, C] float32
/// @param neighbour  [m, k] int64 in [0, n), k >= 1
/// @param weight     [O, C] float32 or bfloat16 (bf16.h), @param bias [O] float32
/// @return  [m, O]
/// @throws c10::Error on a wrong shape, dtype, or an index out of range
/// @note CPU only; not differentiable. Each row is the same bits whatever other rows there are.
at::Tensor neighbour_max_inference(const at::Tensor& dense, const at::Tensor& center,
                                   const at::Tensor& neighbour, const at::Tensor& weight,
                                   const at::Tensor& bias);

/// The same for training: differentiable once in all but `neighbour`. A gradient goes to the first
/// of the pairs that share a maximum.
///
/// @param dense, center  C a multiple of kMaximumBlock
/// @param layer          float32; may have a rounding, which the products of the way forth read
///                       with rounded activations; those of the way back, a few each maximum, read
///                       it with float32 ones
/// @note CPU only. The same bits for any number of threads, gradients included.
at::Tensor neighbour_max(const at::Tensor& dense, const at::Tensor& center,
                         const at::Tensor& neighbour, const LinearWeights& layer);

}  // namespace lte::ops
