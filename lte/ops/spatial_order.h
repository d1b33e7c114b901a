// Points in an order that keeps neighbours together, in which queries are answered fastest.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// An order in which consecutive points are near each other: along the Z curve of 1,024 cells an
/// axis.
///
/// @param points  [N, 3] float32, contiguous, finite, on the CPU
/// @return  [N] int64, a permutation
/// @throws c10::Error on a wrong shape, dtype or layout, or a point that is not finite
/// @note O(N), stable: points of one cell keep their order.
at::Tensor spatial_order(const at::Tensor& points);

}  // namespace lte::ops
