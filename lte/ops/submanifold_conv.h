// Submanifold sparse convolution: outputs only where there are inputs (Graham and van der Maaten
// 2017), as gather-GEMM-scatter by tap over a neighbour map that all blocks of a stage share.
#pragma once

#include <cstdint>
#include <tuple>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Cells of a convolution lie in [0, 2^kConvolutionCellBits) an axis.
inline constexpr int64_t kConvolutionCellBits = 20;

/// The pairs of a kernel of odd edge `kernel`: input cell = output cell + (tap − kernel/2), with
/// tap index ((dx * kernel) + dy) * kernel + dz and dx, dy, dz from 0.
///
/// Where points share a cell, every point is an output. As an input the cell is represented by its
/// lowest-indexed point, except that the centre tap of each point reads the point itself.
///
/// @param cells   [N, 3] int32, contiguous, in [0, 2^kConvolutionCellBits)
/// @param kernel  odd, 1 to 31
/// @return  pairs [2, P] int32 (row 0 output, row 1 input) sorted by tap, then by output;
///          and tap_begin [taps + 1] int64 on the CPU
/// @throws c10::Error on a wrong shape, dtype or layout, a cell outside the range, or a kernel that
///         is even or too wide
/// @note With cells on a GPU the host waits for the number of pairs.
std::tuple<at::Tensor, at::Tensor> convolution_pairs(const at::Tensor& cells, int64_t kernel);

/// Output channels of bfloat16 weights are a multiple of this.
inline constexpr int64_t kConvolutionBlock = 16;

/// out[o] = bias + Σ_(o, i, tap) in[i] W[tap].
///
/// @param input   [N, Cin] float32 (or float64 for gradient checks)
/// @param weight  [taps, Cin, Cout], dtype of `input`; also bfloat16 with a float32 `input`
///                (bf16.h), Cout a multiple of kConvolutionBlock, without a backward pass
/// @param bias    [Cout] or undefined
/// @param pairs, tap_begin  of convolution_pairs()
/// @return  [N, Cout]; differentiable in input, weight and bias
/// @throws c10::Error on a wrong shape, dtype or device, pairs out of order, or, on the CPU, a pair
///         that names a row past the input; on CUDA that fails a device-side assertion
/// @note Deterministic: no atomics, sums in tap order.
at::Tensor submanifold_conv(const at::Tensor& input, const at::Tensor& weight,
                            const at::Tensor& bias, const at::Tensor& pairs,
                            const at::Tensor& tap_begin);

/// submanifold_conv() of training in mixed precision. As in linear_autocast(), input, weight and
/// gradient are rounded to bfloat16 where products read them; sums, result and gradients are
/// float32.
///
/// @param input, weight  float32, Cin and Cout multiples of kConvolutionBlock; others are
///                       submanifold_conv()'s
at::Tensor submanifold_conv_autocast(const at::Tensor& input, const at::Tensor& weight,
                                     const at::Tensor& bias, const at::Tensor& pairs,
                                     const at::Tensor& tap_begin);

}  // namespace lte::ops
