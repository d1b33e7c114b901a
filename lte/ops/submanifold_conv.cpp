#include "lte/ops/submanifold_conv.h"

#include <array>
#include <optional>

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("convolution_pairs(Tensor cells, int kernel) -> (Tensor, Tensor)");
  m.def(
      "submanifold_conv(Tensor input, Tensor weight, Tensor? bias, Tensor pairs, Tensor tap_begin) "
      "-> Tensor");
  // Gradients by input and weight, of the dtype of `grad`; those not needed come back empty. Input
  // and weight may both be bfloat16 with a float32 `grad`, which is then rounded too.
  m.def(
      "submanifold_conv_backward(Tensor grad, Tensor input, Tensor weight, Tensor pairs, "
      "Tensor tap_begin, bool need_input, bool need_weight) -> (Tensor, Tensor)");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

at::Tensor call_forward(const at::Tensor& input, const at::Tensor& weight,
                        const std::optional<at::Tensor>& bias, const at::Tensor& pairs,
                        const at::Tensor& tap_begin) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const std::optional<at::Tensor>&,
                 const at::Tensor&, const at::Tensor&);
  static const auto op = find_operator<Signature>("lte::submanifold_conv");
  return op.call(input, weight, bias, pairs, tap_begin);
}

class SubmanifoldConv : public torch::autograd::Function<SubmanifoldConv> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& input,
                            const at::Tensor& weight, const std::optional<at::Tensor>& bias,
                            const at::Tensor& pairs, const at::Tensor& tap_begin, bool bf16) {
    const at::AutoDispatchBelowADInplaceOrView below;
    const auto rounded = [&](const at::Tensor& t) { return bf16 ? t.to(at::kBFloat16) : t; };
    const at::Tensor read = rounded(weight);
    context->save_for_backward({rounded(input), read, pairs, tap_begin});
    return call_forward(input, read, bias, pairs, tap_begin);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature =
        std::tuple<at::Tensor, at::Tensor>(const at::Tensor&, const at::Tensor&, const at::Tensor&,
                                           const at::Tensor&, const at::Tensor&, bool, bool);
    static const auto op = find_operator<Signature>("lte::submanifold_conv_backward");
    const variable_list saved = context->get_saved_variables();
    const at::Tensor grad = grads[0].contiguous();
    // Counted over tensor arguments: without a bias, 2 is `pairs`, which needs none.
    const bool need_bias = context->needs_input_grad(2);
    const auto [input, weight] =
        op.call(grad, saved[0], saved[1], saved[2], saved[3], context->needs_input_grad(0),
                context->needs_input_grad(1));
    const at::Tensor bias = need_bias ? grad.sum(0) : at::Tensor();
    return {context->needs_input_grad(0) ? input : at::Tensor(),
            context->needs_input_grad(1) ? weight : at::Tensor(),
            bias,
            at::Tensor(),
            at::Tensor(),
            at::Tensor()};
  }
};

at::Tensor submanifold_conv_autograd(const at::Tensor& input, const at::Tensor& weight,
                                     const std::optional<at::Tensor>& bias, const at::Tensor& pairs,
                                     const at::Tensor& tap_begin) {
  return SubmanifoldConv::apply(input, weight, bias, pairs, tap_begin, false);
}

}  // namespace

std::tuple<at::Tensor, at::Tensor> convolution_pairs(const at::Tensor& cells, int64_t kernel) {
  static const auto op = find_operator<decltype(convolution_pairs)>("lte::convolution_pairs");
  return op.call(cells, kernel);
}

at::Tensor submanifold_conv(const at::Tensor& input, const at::Tensor& weight,
                            const at::Tensor& bias, const at::Tensor& pairs,
                            const at::Tensor& tap_begin) {
  return call_forward(input, weight, bias.defined() ? std::optional(bias) : std::nullopt, pairs,
                      tap_begin);
}

at::Tensor submanifold_conv_autocast(const at::Tensor& input, const at::Tensor& weight,
                                     const at::Tensor& bias, const at::Tensor& pairs,
                                     const at::Tensor& tap_begin) {
  const bool whole = weight.dim() == 3 && weight.size(1) % kConvolutionBlock == 0 &&
                     weight.size(2) % kConvolutionBlock == 0;
  const bool single = input.scalar_type() == at::kFloat && weight.scalar_type() == at::kFloat;
  if (!whole || !single) return submanifold_conv(input, weight, bias, pairs, tap_begin);
  return SubmanifoldConv::apply(input, weight, bias.defined() ? std::optional(bias) : std::nullopt,
                                pairs, tap_begin, true);
}

}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, Autograd, m) {
  m.impl("submanifold_conv", lte::ops::submanifold_conv_autograd);
}
