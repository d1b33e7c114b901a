#include "lte/ops/orthogonal.h"

#include "lte/ops/cpu/dense/orthogonal_cpu.h"
#include "lte/tensor/functions.h"

namespace lte::ops {
namespace {

/// The same by ATen's batches, on other devices.
at::Tensor orthogonal_of_batch(const at::Tensor& matrices) {
  using Step = NewtonSchulz;
  at::Tensor gram = at::bmm(matrices.mT(), matrices);
  const at::Tensor square =
      gram.diagonal(0, 1, 2).sum(-1).clamp_min(Step::kMinSquare).view({-1, 1, 1});  // Frobenius
  gram = gram / square;
  const at::Tensor one = at::eye(gram.size(1), gram.options()).expand_as(gram);
  at::Tensor factor = one / square.sqrt();
  for (int step = 0; step < Step::kSteps; ++step) {
    const at::Tensor change = Step::kA * one + Step::kB * gram + Step::kC * at::bmm(gram, gram);
    factor = at::bmm(factor, change);
    if (step + 1 < Step::kSteps) gram = at::bmm(at::bmm(change, gram), change);
  }
  return at::bmm(matrices, factor);
}

}  // namespace

at::Tensor orthogonal(const at::Tensor& matrices) {
  TORCH_CHECK(matrices.dim() == 3 && matrices.scalar_type() == at::kFloat,
              "orthogonal: matrices must be [B, N, M] float32, got ", matrices.sizes(), " ",
              matrices.scalar_type());
  const at::NoGradGuard no_grad;
  if (matrices.size(1) < matrices.size(2)) return orthogonal(matrices.mT()).mT();
  return matrices.device().is_cpu() ? orthogonal_cpu(matrices.contiguous())
                                    : orthogonal_of_batch(matrices);
}

}  // namespace lte::ops
