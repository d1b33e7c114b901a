// Radiance by direction from a point's learnt lobes in one operator: what the late head of
// nn::RadianceDecoder computes for each direction (docs/model.md, "Radiance by direction").
#pragma once

#include <cstdint>

#include "lte/ops/decoder_weights.h"
#include "lte/ops/surfel_columns.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// What all points share.
struct LobeWeights {
  LinearWeights mix;    ///< K -> K, or K + kSeenFeatures -> K with `seen`
  LinearWeights color;  ///< K -> 3, or 6 with `seen`
};

/// r ⊙ light + s ⊙ the radiance seen, where r, s = softplus(color(GELU(mix([h, f]) + c))),
/// h_k = GELU(a_k · ω + b_k), and f are the other columns of what is seen.
///
/// @param own         [Q, 5 K] float32, of each point a [K, 3], b [K] and c [K]
/// @param directions  [Q, N, 3] float32, ω
/// @param light       [Q, 3] float32; undefined: 1
/// @param seen        [Q, N, kSeenColumns] float32; undefined: there is neither f nor s
/// @param weights     float32; that of `mix` may be bfloat16 instead (bf16.h)
/// @return  [Q, N, 3]
/// @throws c10::Error on a wrong shape, dtype or device
/// @note Not differentiable. On the CPU each row is the same bits whatever other rows there are.
/// @note On CUDA at most 6,000 lobes: two numbers of each lie in the 48 KiB that a block shares.
at::Tensor lobe_radiance_inference(const at::Tensor& own, const at::Tensor& directions,
                                   const at::Tensor& light, const at::Tensor& seen,
                                   const LobeWeights& weights);

}  // namespace lte::ops
