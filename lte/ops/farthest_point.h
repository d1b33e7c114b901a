// Farthest point sampling: the blue-noise subset of the paper's nearest-neighbour embedding
// (equation 1).
#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Greedy maximin picks: point 0 first, then always the point farthest from all picks; ties go to
/// the lower index. Runs are nested: the first c picks of a longer run are the run of c.
///
/// @param points  [N, 3] float32, contiguous, finite
/// @param count   0 <= count <= N
/// @return  indices [count] int64 in the order of the picks, and insertion distances² [count]
///          float32: from each pick to the nearest pick before it, non-increasing; +inf for the
///          first
/// @throws c10::Error on a wrong shape, dtype, layout or `count`, or, on the CPU, non-finite input
///         (naming the row); a GPU would have to be waited for
/// @note Exact; duplicates are picked last, at distance 0. CPU and CUDA agree bit for bit. Not
///       differentiable.
std::tuple<at::Tensor, at::Tensor> farthest_point_sampling(const at::Tensor& points, int64_t count);

/// The same of several sets of points, each as by itself: of a GPU's, many beside each other, as
/// one keeps but one multiprocessor busy, and few on the host, which is quicker with each.
///
/// @param sets    all on one device
/// @param counts  one for each set
/// @return  indices and insertion distances² of each set
/// @throws c10::Error as farthest_point_sampling(), or if there are not as many counts as sets
std::tuple<std::vector<at::Tensor>, std::vector<at::Tensor>> farthest_point_sampling_of_sets(
    at::TensorList sets, at::IntArrayRef counts);

}  // namespace lte::ops
