#include "lte/ops/cpu/dense/gelu_cpu.h"

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/tensor/functions.h"

namespace lte::ops {
namespace {

constexpr int64_t kGeluGrain =
    16384;  ///< numbers below which a second thread costs more than it gains

}  // namespace

at::Tensor gelu_cpu(const at::Tensor& any_x) {
  const at::Tensor x = any_x.contiguous();
  at::Tensor out = at::empty(x.sizes(), x.options());
  const auto* from = x.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, x.numel(), kGeluGrain, [&](int64_t begin, int64_t end) {
    dense_kernels().activate_row(from + begin, end - begin, to + begin);
  });
  return out;
}

at::Tensor gelu_gradient_cpu(const at::Tensor& any_x, const at::Tensor& any_grad) {
  const at::Tensor x = any_x.contiguous(), grad = any_grad.contiguous();
  at::Tensor out = at::empty(x.sizes(), x.options());
  const auto* from = x.const_data_ptr<float>();
  const auto* g = grad.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, x.numel(), kGeluGrain, [&](int64_t begin, int64_t end) {
    dense_kernels().activate_gradient(from + begin, g + begin, end - begin, to + begin);
  });
  return out;
}

}  // namespace lte::ops
