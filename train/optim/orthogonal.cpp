#include "train/optim/orthogonal.h"

#include <ATen/TensorOperators.h>
#include <ATen/ops/bmm.h>
#include <ATen/ops/eye.h>

namespace lte::train {

at::Tensor orthogonal(const at::Tensor& matrices) {
  constexpr double kA = 3.4445, kB = -4.7750, kC = 2.0315;
  constexpr int kSteps = 5;
  constexpr double kLeastSquare = 1e-30;
  if (matrices.size(1) < matrices.size(2)) return orthogonal(matrices.mT()).mT();
  at::Tensor gram = at::bmm(matrices.mT(), matrices);
  const at::Tensor square =
      gram.diagonal(0, 1, 2).sum(-1).clamp_min(kLeastSquare).view({-1, 1, 1});  // Frobenius
  gram = gram / square;
  const at::Tensor one = at::eye(gram.size(1), gram.options()).expand_as(gram);
  at::Tensor factor = one / square.sqrt();
  for (int step = 0; step < kSteps; ++step) {
    const at::Tensor change = kA * one + kB * gram + kC * at::bmm(gram, gram);
    factor = at::bmm(factor, change);
    if (step + 1 < kSteps) gram = at::bmm(at::bmm(change, gram), change);
  }
  return at::bmm(matrices, factor);
}

}  // namespace lte::train
