#include "lte/ops/patch_attention.h"

#include <optional>
#include <tuple>

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "patch_attention_inference(Tensor qkv, Tensor? gather, Tensor? inverse, int heads, int "
      "patch, bool bf16=False) -> Tensor");
  // The answer, and log2 of the sum of 2^score of each slot and head, scores in units of log 2.
  m.def(
      "patch_attention(Tensor qkv, Tensor? gather, Tensor? inverse, int heads, int patch, bool "
      "bf16) -> (Tensor, Tensor)");
  // The gradient by qkv.
  m.def(
      "patch_attention_backward(Tensor grad, Tensor qkv, Tensor out, Tensor log_sum, Tensor? "
      "gather, Tensor? inverse, int heads, int patch, bool bf16) -> Tensor");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;
using Slots = std::optional<at::Tensor>;

Slots given(const at::Tensor& slots) { return slots.defined() ? Slots(slots) : std::nullopt; }

class PatchAttention : public torch::autograd::Function<PatchAttention> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& qkv, const Slots& gather,
                            const Slots& inverse, int64_t heads, int64_t patch, bool bf16) {
    using Signature = std::tuple<at::Tensor, at::Tensor>(const at::Tensor&, const Slots&,
                                                         const Slots&, int64_t, int64_t, bool);
    static const auto op = find_operator<Signature>("lte::patch_attention");
    const at::AutoDispatchBelowADInplaceOrView below;
    const auto [out, log_sum] = op.call(qkv, gather, inverse, heads, patch, bf16);
    context->save_for_backward(
        {qkv, out, log_sum, gather.value_or(at::Tensor()), inverse.value_or(at::Tensor())});
    context->saved_data["heads"] = heads;
    context->saved_data["patch"] = patch;
    context->saved_data["bf16"] = bf16;
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature =
        at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
                   const Slots&, const Slots&, int64_t, int64_t, bool);
    static const auto op = find_operator<Signature>("lte::patch_attention_backward");
    const variable_list saved = context->get_saved_variables();
    const at::Tensor by_qkv =
        op.call(grads[0], saved[0], saved[1], saved[2], given(saved[3]), given(saved[4]),
                context->saved_data["heads"].toInt(), context->saved_data["patch"].toInt(),
                context->saved_data["bf16"].toBool());
    return {by_qkv, at::Tensor(), at::Tensor(), at::Tensor(), at::Tensor(), at::Tensor()};
  }
};

}  // namespace

at::Tensor patch_attention(const at::Tensor& qkv, const at::Tensor& gather,
                           const at::Tensor& inverse, int64_t heads, int64_t patch, bool bf16) {
  return PatchAttention::apply(qkv, given(gather), given(inverse), heads, patch, bf16);
}

at::Tensor patch_attention_inference(const at::Tensor& qkv, const at::Tensor& gather,
                                     const at::Tensor& inverse, int64_t heads, int64_t patch,
                                     bool bf16) {
  using Signature =
      at::Tensor(const at::Tensor&, const Slots&, const Slots&, int64_t, int64_t, bool);
  static const auto op = find_operator<Signature>("lte::patch_attention_inference");
  return op.call(qkv, given(gather), given(inverse), heads, patch, bf16);
}

}  // namespace lte::ops
