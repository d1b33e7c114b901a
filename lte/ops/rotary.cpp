#include "lte/ops/rotary.h"

#include "lte/ops/cpu/attention/rotary_cpu.h"
#include "lte/ops/rotary_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// A rotation's transpose is its inverse: gradients turn back.
class RotateHeads : public torch::autograd::Function<RotateHeads> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& qkv,
                            const at::Tensor& cosine, const at::Tensor& sine, int64_t heads) {
    const at::AutoDispatchBelowADInplaceOrView below;
    context->save_for_backward({cosine, sine});
    context->saved_data["heads"] = heads;
    return rotate_heads_cpu(qkv, cosine, sine, heads, /*back=*/false);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    const int64_t heads = context->saved_data["heads"].toInt();
    return {rotate_heads_cpu(grads[0], saved[0], saved[1], heads, /*back=*/true), {}, {}, {}};
  }
};

/// The same on any device and in any dtype.
at::Tensor composed_rotation(const at::Tensor& qkv, const at::Tensor& cosine,
                             const at::Tensor& sine, int64_t heads) {
  const int64_t n = qkv.size(0), pairs = cosine.size(1);
  const at::Tensor parts = qkv.reshape({n, 3, heads, 2, pairs}), turned = parts.narrow(1, 0, 2);
  const at::Tensor a = turned.select(3, 0), b = turned.select(3, 1);  // [n, 2, heads, pairs]
  const at::Tensor c = cosine.to(qkv.scalar_type()).view({n, 1, 1, pairs}),
                   s = sine.to(qkv.scalar_type()).view({n, 1, 1, pairs});
  const at::Tensor first = a.mul(c).sub(b.mul(s)), second = a.mul(s).add(b.mul(c));
  return at::cat({at::stack({first, second}, 3), parts.narrow(1, 2, 1)}, 1).view({n, qkv.size(1)});
}

}  // namespace

at::Tensor rotate_heads(const at::Tensor& qkv, const at::Tensor& cosine, const at::Tensor& sine,
                        int64_t heads) {
  check_rotate_heads_args(qkv, cosine, sine, heads);
  if (!qkv.device().is_cpu() || qkv.scalar_type() != at::kFloat)
    return composed_rotation(qkv, cosine, sine, heads);
  return RotateHeads::apply(qkv, cosine, sine, heads);
}

}  // namespace lte::ops
