// Farthest point sampling: the blue-noise subset of the paper's nearest-neighbour embedding
// (equation 1).
#pragma once

#include <cstdint>
#include <tuple>

#include <ATen/core/Tensor.h>

namespace lte::ops {

/// Greedy maximin picks: point 0 first, then always the point farthest from all picks; ties by
/// lower index. Nested: the first c picks of a longer run are the run of c.
///
/// @param points  [N, 3] float32, contiguous, finite
/// @param count   0 <= count <= N
/// @return  indices [count] int64 in pick order, and insertion distance² [count] float32: that of
/// each pick to the picks
///          before it, non-increasing; +inf for the first
/// @throws c10::Error on a wrong shape, dtype, layout or `count`, or, on the CPU, non-finite input
/// @note Exact; duplicates are picked last, at distance 0. Not differentiable.
std::tuple<at::Tensor, at::Tensor> farthest_point_sampling(const at::Tensor& points, int64_t count);

}  // namespace lte::ops
