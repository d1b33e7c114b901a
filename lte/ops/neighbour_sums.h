// The gather-reduce of the query decoder's factored vector attention (the paper's section 3.4).
//
//   Σ_κ (q − k_κ + P_κ) ⊙ (v_κ + P_κ) = q ⊙ S1 + S2
//   with S1 = Σ (v_κ + P_κ) and S2 = Σ (P_κ − k_κ) ⊙ (v_κ + P_κ)
//
// There is no softmax over κ, so the query factors out: both sums of all layers are made in one
// pass over the neighbours, before any layer runs.
#pragma once

#include <cstdint>
#include <tuple>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// S1 and S2 of every layer and query.
///
/// @param keys      [L, m, C] float32 (or float64), W_k F of every layer and latent
/// @param values    [L, m, C], W_v F
/// @param position  [Q, K, C], P = γ(p_j − p_κ), shared by the layers
/// @param index     [Q, K] int64, the neighbours of each query, in [0, m)
/// @return  S1 and S2, each [L, Q, C], NOT yet scaled by 1/K; differentiable in keys, values and
///          position
/// @throws c10::Error on a wrong shape, dtype or device, or, on the CPU, an index out of range; on
///         CUDA such an index fails a device-side assertion
/// @note No [Q, K, C] temporary besides `position`. Deterministic, gradients included.
std::tuple<at::Tensor, at::Tensor> neighbour_sums(const at::Tensor& keys, const at::Tensor& values,
                                                  const at::Tensor& position,
                                                  const at::Tensor& index);

/// What inference gathers, made once an embedding. On the CPU keys and values are interleaved, so
/// that a query reads one run of memory from a latent for a block of channels and all layers.
///
/// @param keys, values  as of neighbour_sums()
/// @return  opaque to callers, but that its axis of latents can be sliced on the CPU, the first:
///          [m, ⌈C/16⌉, L, 2, 16], k, then v, of 16 channels, channels past C zero, with a gap
///          after each latent; on CUDA [2, L, m, C]
/// @throws c10::Error on a wrong shape, dtype or device
at::Tensor neighbour_table(const at::Tensor& keys, const at::Tensor& values);

/// neighbour_sums() from the table; not differentiable, float32, and fused with γ's last layer so
/// that P never exists: P_κ = hidden_κ Wᵀ + b.
///
/// @param table   neighbour_table() of float32 keys and values
/// @param hidden  [Q, K, H] float32, γ's activations before its last layer
/// @param weight  [C, H], @param bias [C]: γ's last layer
/// @param index   [Q, K] int64
/// @return  S1 and S2, each [L, Q, C], not yet scaled by 1/K
/// @throws c10::Error as neighbour_sums()
/// @note On the CPU each query's result is the same bits whatever other queries there are.
/// @note Blocks of some 4,096 queries keep the results in memory that the allocator reuses.
std::tuple<at::Tensor, at::Tensor> neighbour_sums_inference(const at::Tensor& table,
                                                            const at::Tensor& hidden,
                                                            const at::Tensor& weight,
                                                            const at::Tensor& bias,
                                                            const at::Tensor& index);

}  // namespace lte::ops
