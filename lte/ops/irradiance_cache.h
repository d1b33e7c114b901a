// Irradiance read between points at which it is known, one pass over the neighbours of each query
// (Ward et al. 1988, "A Ray Tracing Solution for Diffuse Interreflection").
#pragma once

#include <cstdint>

#include <ATen/core/Tensor.h>

#include "lte/ops/cache_weights.h"

namespace lte::ops {

/// Columns of irradiance_cache_means().
inline constexpr int64_t kCacheMeans = 12;

/// Of each query, over the K points near it:
///   0–5  Σ w_j light_j / Σ w_j
///   6    Σ w_j (g_j − g)² / Σ w_j, g_j the mean of a point's first three channels, g that of the
///        first three columns
///   7    Σ w_j
///   8, 9 plain means of max(0, n·n_j) and of h_j / d̄
///   10   plain mean of g_j
///   11   d̄²
///
/// @param position  [Q, 3] float32, @param normal [Q, 3] likewise, of the queries
/// @param points    [S, 3], @param normals [S, 3] and @param light [S, 6] float32, of the cache
/// @param index     [Q, K] int64 in [0, S), 1 <= K <= 64
/// @return  [Q, kCacheMeans]
/// @throws c10::Error on a wrong shape or dtype, or an index out of range
/// @note CPU only; not differentiable. Each row is the same bits whatever other rows there are.
at::Tensor irradiance_cache_means(const at::Tensor& position, const at::Tensor& normal,
                                  const at::Tensor& points, const at::Tensor& normals,
                                  const at::Tensor& light, const at::Tensor& index,
                                  const CacheWeights& weights);

}  // namespace lte::ops
