// Irradiance read between points at which it is known, one pass over the neighbours of each query
// (Ward et al. 1988, "A Ray Tracing Solution for Diffuse Interreflection").
#pragma once

#include <cstdint>

#include <ATen/core/Tensor.h>

#include "lte/ops/cache_columns.h"

namespace lte::ops {

/// The columns of CacheColumn for every query, over the K points near it.
///
/// @param position  [Q, 3] float32, @param normal [Q, 3] likewise, of the queries
/// @param points    [S, 3] float32, of the cache
/// @param normals   [S, 3 sides] float32 for 1 to kMostCacheSides sides of each point: unit, or
///                  shorter for a side that counts for less
/// @param light     [S, kCacheLight sides] float32
/// @param errors    [S, sides] float32, of the mean of the first three channels over that mean; or
///                  undefined
/// @param index     [Q, K] int64 in [0, S), 1 <= K <= kMostCacheNeighbours
/// @return  [Q, kCacheMeans], with errors one column more
/// @throws c10::Error on a wrong shape, dtype or device, or an index out of range
/// @note CPU only; not differentiable. Each row is the same bits whatever other rows there are.
at::Tensor irradiance_cache_means(const at::Tensor& position, const at::Tensor& normal,
                                  const at::Tensor& points, const at::Tensor& normals,
                                  const at::Tensor& light, const at::Tensor& errors,
                                  const at::Tensor& index, const CacheWeights& weights);

}  // namespace lte::ops
