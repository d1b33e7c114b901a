// Matrices made orthogonal, the step of Muon: a gradient says by its singular vectors in which
// directions a layer should move, and by its singular values hardly how far.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The matrices with their singular values brought near 1 and their singular vectors kept, by five
/// Newton-Schulz steps of the coefficients of Jordan et al. (2024, "Muon: an optimizer for hidden
/// layers in neural networks"). All steps are polynomials of one Gram matrix, so they are done on
/// that: M × M numbers for N rows and M < N columns.
/// @param matrices  [B, N, M] float32, on any device
/// @return          [B, N, M]; singular values from 0.68 to 1.14, lower for those that are below
///                  1/500 of a matrix's Frobenius norm. A matrix of zeros stays one.
/// @throws c10::Error on another number of dimensions or another dtype
/// @note Not differentiable. On the CPU each matrix's result is the same bits whatever others there
///       are and for any number of threads.
at::Tensor orthogonal(const at::Tensor& matrices);

}  // namespace lte::ops
