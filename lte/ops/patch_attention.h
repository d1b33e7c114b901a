// Attention within patches of points, scores and all intermediates in the caches (PTv3's
// serialized attention, Wu et al. 2024).
#pragma once

#include <cstdint>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The most channels that a head may have.
inline constexpr int64_t kWidestHead = 128;

/// softmax(Q Kᵀ / sqrt(d)) V within each patch and head.
///
/// @param qkv      [n, 3C] float32: queries, keys, values; within each, heads of d = C / heads
///                 channels
/// @param gather   [patches * patch] int64, the point in each slot, every point at least once; or
///                 undefined: one patch of all points
/// @param inverse  [n] int64, the slot whose result a point takes; undefined with `gather`
/// @param heads    divides C; d <= kWidestHead
/// @param patch    slots of a patch; not read without `gather`
/// @param bf16     round queries, keys, values and weights as products read them (bf16.h)
/// @return  [n, C]
/// @throws c10::Error on a wrong shape, dtype, or an index out of range
/// @note CPU only; not differentiable. The same bits for any number of threads.
at::Tensor patch_attention_inference(const at::Tensor& qkv, const at::Tensor& gather,
                                     const at::Tensor& inverse, int64_t heads, int64_t patch,
                                     bool bf16 = false);

/// The same for training: differentiable once in qkv. Nothing of the size of queries × keys is kept
/// for the gradient.
///
/// @param bf16  round what products read on the way back too: gradients of answers and scores
/// @note CPU only. The same bits for any number of threads, gradients included.
at::Tensor patch_attention(const at::Tensor& qkv, const at::Tensor& gather,
                           const at::Tensor& inverse, int64_t heads, int64_t patch,
                           bool bf16 = false);

}  // namespace lte::ops
