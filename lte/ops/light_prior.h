// Irradiance read between points at which it is known, one pass over the neighbours of each query
// (Ward et al. 1988, "A Ray Tracing Solution for Diffuse Interreflection").
#pragma once

#include <cstdint>

#include "lte/ops/prior_columns.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The columns of PriorColumn of every query, over the K points near it.
///
/// @param position  [Q, 3] float32, @param normal [Q, 3] likewise, of the queries
/// @param points    [S, 3] float32
/// @param normals   [S, 6] float32 of the two sides of each point: unit, or shorter for a side that
///                  counts for less
/// @param light     [S, 2 kPriorLight] float32 of the two sides
/// @param errors    [S, 2] float32, of the mean of a side's first three channels over that mean; or
///                  undefined
/// @param index     [Q, K] int64 in [0, S), 1 <= K <= kMaxPriorNeighbours
/// @return  [Q, kPriorMeans], with errors one column more
/// @throws c10::Error on a wrong shape, dtype or device, or an index out of range
/// @note CPU only; not differentiable. Each row is the same bits whatever other rows there are.
at::Tensor light_prior_means(const at::Tensor& position, const at::Tensor& normal,
                             const at::Tensor& points, const at::Tensor& normals,
                             const at::Tensor& light, const at::Tensor& errors,
                             const at::Tensor& index, const PriorWeights& weights);

/// What a decoder reads of the means: with g the mean of the first three columns,
/// log(1 + light) of each of kPriorLight, log(1 + √variance / (g + s)), log(weight) / l, facing,
/// height, log(1 + gray) − log(1 + g), (log(d̄²) + t) / l, and where there is noise
/// √noise / (g + s).
///
/// @param means  [Q, C] float32 of light_prior_means()
/// @return       [Q, C]
/// @throws c10::Error on another shape, dtype or device
/// @note As light_prior_means().
at::Tensor light_prior_features(const at::Tensor& means, const PriorScales& scales);

}  // namespace lte::ops
