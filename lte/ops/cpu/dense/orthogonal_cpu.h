// orthogonal() (lte/ops/orthogonal.h) on the CPU.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// What a Newton-Schulz step multiplies the singular values by: a + b s² + c s⁴ of the singular
/// value s, which is at most 1.
struct NewtonSchulz {
  static constexpr int kSteps = 5;
  static constexpr float kA = 3.4445f, kB = -4.7750f, kC = 2.0315f;
  static constexpr float kMinSquare = 1e-30f;  ///< of a Frobenius norm
};

/// @param matrices  [B, N, M] float32, contiguous, N >= M
at::Tensor orthogonal_cpu(const at::Tensor& matrices);

}  // namespace lte::ops
