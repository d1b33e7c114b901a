// What a query gathers from its neighbours by weights that add up to one: the vector attention of
// Point Transformer (Zhao et al. 2021), against which the paper's unnormalized sum is measured.
#pragma once

#include <ATen/core/Tensor.h>

#include "lte/nn/mlp.h"

namespace lte::nn {

/// The weights alone, softmax_κ(ω(relation)) over the neighbours in each channel.
/// @param relation  [Q, κ, D], q − k_κ + P_κ
at::Tensor softmax_weights(Mlp& omega, const at::Tensor& relation);

/// Σ_κ softmax_κ(ω(q − k_κ + P_κ)) ⊙ (v_κ + P_κ), the softmax over the neighbours in each channel.
///
/// @param omega  ω, D -> D -> D
/// @param query  [Q, D], q
/// @param key    [m, D], k, and value [m, D], v, of the latents
/// @param place  [Q, κ, D], P
/// @param index  [Q, κ] int64, the latents near each query
/// @return  [Q, D], differentiable by all but `index`
/// @note Unlike the sum, it does not come apart into sums that no query enters: κ products of D × D
///       a query.
at::Tensor softmax_attention(Mlp& omega, const at::Tensor& query, const at::Tensor& key,
                             const at::Tensor& value, const at::Tensor& place,
                             const at::Tensor& index);

}  // namespace lte::nn
