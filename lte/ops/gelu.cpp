#include "lte/ops/gelu.h"

#include "lte/ops/cpu/dense/gelu_cpu.h"
#include "lte/ops/gelu_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

class Gelu : public torch::autograd::Function<Gelu> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x) {
    const at::AutoDispatchBelowADInplaceOrView below;
    context->save_for_backward({x});
    return gelu_cpu(x);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    return {gelu_gradient_cpu(context->get_saved_variables()[0], grads[0])};
  }
};

}  // namespace

at::Tensor gelu(const at::Tensor& x) {
  check_gelu_args(x);
  if (!x.device().is_cpu() || x.scalar_type() != at::kFloat) return at::gelu(x);
  return Gelu::apply(x);
}

}  // namespace lte::ops
