// The matrix products of a submanifold convolution in float32, those of all taps in one launch:
// alone each would be over before the next is launched.
#pragma once

#include <cstdint>

#include <ATen/core/Tensor.h>

namespace lte::ops {

/// Kernels of more taps than 7³ go tap by tap: theirs no longer fit among a launch's arguments.
inline constexpr int64_t kMaxTaps = 343;

/// products[p] = rows[row[p]] W[tap of p], or W's transpose.
///
/// @param rows        [N, A] float32, contiguous, on CUDA
/// @param row         [P] int32, contiguous, in [0, N)
/// @param weight      [taps, A, B] float32, contiguous; `transposed`: [taps, B, A]
/// @param tap_begin   [taps + 1] int64 on the CPU, of P; at most kMaxTaps taps
/// @return [P, B]
at::Tensor products_by_tap(const at::Tensor& rows, const at::Tensor& row, const at::Tensor& weight,
                           const at::Tensor& tap_begin, bool transposed);

/// out[tap] = Σ_p left[left_row[p]]ᵀ right[right_row[p]] over the pairs of the tap: always in the
/// same order.
///
/// @param left, right          [N, A] and [N, B] float32, contiguous
/// @param left_row, right_row  [P] int32, contiguous
/// @return [taps, A, B]
at::Tensor outer_products_by_tap(const at::Tensor& left, const at::Tensor& left_row,
                                 const at::Tensor& right, const at::Tensor& right_row,
                                 const at::Tensor& tap_begin);

}  // namespace lte::ops
