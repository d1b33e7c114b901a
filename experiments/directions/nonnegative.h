// Least squares whose unknowns may not be negative.
#pragma once

#include <ATen/core/Tensor.h>

namespace lte::experiments {

/// argmin |A x − b|² over x ≥ 0 by the active-set method of Lawson and Hanson (Solving Least
/// Squares Problems, 1974), on normal equations (Bro and de Jong, A Fast Non-Negativity-Constrained
/// Least Squares Algorithm, 1997).
/// @param gram     [B, L, L] float64: AᵀA of each problem, with a positive diagonal
/// @param moments  [B, L, T] float64: Aᵀb of its T right-hand sides
/// @param start    [B, L, T] non-negative guess, whose zeros are likely those of the answer;
///                 undefined: 0
/// @return         [B, L, T] float64
/// @note  On several threads. The diagonal is raised by 10⁻¹⁰ of itself, so that columns of A may
///        repeat.
at::Tensor nonnegative_least_squares(const at::Tensor& gram, const at::Tensor& moments,
                                     const at::Tensor& start = {});

}  // namespace lte::experiments
