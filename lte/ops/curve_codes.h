// Space-filling curves: from grid cells to positions along a curve (PTv3's serialization).
#pragma once

#include <cstdint>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The transposed variants are the same curve with x and y swapped.
enum class Curve : int64_t { Z = 0, ZTransposed = 1, Hilbert = 2, HilbertTransposed = 3 };

inline constexpr int64_t kCurveBits = 16;

/// The position of each cell along a curve. Bit i of x lands on bit 3i+2 of the Z code, y on 3i+1,
/// z on 3i; Hilbert is Skilling's (2004) construction in the same axis order.
///
/// @param cells  [N, 3] int32, contiguous, in [0, 2^bits)
/// @param bits   bits an axis, 1 to 21
/// @return       [N] int64, non-negative; CPU and CUDA agree bit for bit
/// @throws c10::Error on a wrong shape, dtype, layout or `bits`, or, on the CPU, a cell outside the
///         range; on CUDA such a cell fails a device-side assertion
/// @note O(N), no scratch memory. Not differentiable.
at::Tensor curve_codes(const at::Tensor& cells, Curve curve, int64_t bits = kCurveBits);

}  // namespace lte::ops
