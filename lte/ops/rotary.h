// Rotary positions (Su et al. 2021, "RoFormer"): queries and keys of attention are turned by angles
// of their points, so that a product of the two depends on where the points lie to each other.
#pragma once

#include <cstdint>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Turns the queries and keys of multi-head attention. Within a head of d channels, channels i and
/// i + d/2 are a pair (a, b) that becomes (a cos − b sin, a sin + b cos) by the point's i-th angle.
///
/// @param qkv     [n, 3C] floating point: q, k, v; within each heads, then the d = C / heads
///                channels of a head, d even
/// @param cosine  [n, d/2] float32, and `sine` likewise, of the points' angles
/// @return  [n, 3C], v as it was; differentiable in qkv
/// @throws c10::Error on a wrong shape, dtype or device
at::Tensor rotate_heads(const at::Tensor& qkv, const at::Tensor& cosine, const at::Tensor& sine,
                        int64_t heads);

}  // namespace lte::ops
