#include "lte/ops/linear.h"

#include <optional>
#include <vector>

#include "lte/ops/dispatch.h"
#include "lte/ops/gelu.h"
#include "lte/ops/linear_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  // x and bias float32, weight that or bfloat16.
  m.def("linear_rows(Tensor x, Tensor weight, Tensor? bias, bool gelu) -> Tensor");
  // gradᵀ x: grad [N, O] float32, x [N, C] float32 or bfloat16, then of both rounded -> [O, C]
  // float32.
  m.def("weight_gradient(Tensor grad, Tensor x) -> Tensor");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

std::optional<at::Tensor> if_defined(const at::Tensor& t) {
  return t.defined() ? std::optional(t) : std::nullopt;
}

/// float32 rows, and weights of float32 on the CPU or of bfloat16 anywhere.
bool suits_rows(const at::Tensor& x, const at::Tensor& weight) {
  const bool single = weight.scalar_type() == at::kFloat && x.device().is_cpu();
  return x.scalar_type() == at::kFloat && weight.size(1) > 0 &&
         (single || weight.scalar_type() == at::kBFloat16);
}

at::Tensor call_rows(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias,
                     bool gelu) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const std::optional<at::Tensor>&, bool);
  static const auto op = find_operator<Signature>("lte::linear_rows");
  return op.call(x, weight, if_defined(bias), gelu);
}

at::Tensor call_weight_gradient(const at::Tensor& grad, const at::Tensor& x) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&);
  static const auto op = find_operator<Signature>("lte::weight_gradient");
  return op.call(grad, x);
}

/// x Wᵀ + b for an x of any shape, whose rows are given.
at::Tensor linear_of_rows(const at::Tensor& rows, const at::Tensor& weight, const at::Tensor& bias,
                          at::IntArrayRef x_sizes) {
  std::vector<int64_t> sizes = x_sizes.vec();
  sizes.back() = weight.size(0);
  return call_rows(rows, weight, bias, false).view(sizes);
}

class Linear : public torch::autograd::Function<Linear> {
 public:
  /// @param bf16  whether products read x, weight and gradient rounded
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x, const at::Tensor& weight,
                            const std::optional<at::Tensor>& bias, bool bf16) {
    const at::AutoDispatchBelowADInplaceOrView below;
    const auto read = [&](const at::Tensor& t) { return bf16 ? t.to(at::kBFloat16) : t; };
    const at::Tensor rows = x.reshape({-1, weight.size(1)}).contiguous();
    const at::Tensor factor = read(weight).contiguous();
    context->save_for_backward({read(rows), factor});
    context->saved_data["sizes"] = x.sizes();
    context->saved_data["has_bias"] = bias.has_value();
    return linear_of_rows(rows, factor, bias.value_or(at::Tensor()), x.sizes());
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    const at::Tensor &x = saved[0], &weight = saved[1];
    const at::Tensor grad = grads[0].reshape({-1, weight.size(0)}).contiguous();
    variable_list out(4);
    if (context->needs_input_grad(0)) {
      out[0] =
          call_rows(grad, weight.t(), {}, false).view(context->saved_data["sizes"].toIntVector());
    }
    if (context->needs_input_grad(1)) out[1] = call_weight_gradient(grad, x);
    // Counted over tensors: without a bias there is no third.
    if (context->saved_data["has_bias"].toBool() && context->needs_input_grad(2)) {
      out[2] = grad.sum(0);
    }
    return out;
  }
};

bool wants_gradient(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  return at::GradMode::is_enabled() &&
         (x.requires_grad() || weight.requires_grad() || (bias.defined() && bias.requires_grad()));
}

}  // namespace

at::Tensor linear(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  check_linear_args(x, weight, bias);
  if (!suits_rows(x, weight)) return at::linear(x, weight, if_defined(bias));
  const bool differentiable = weight.scalar_type() == at::kFloat;
  return differentiable && wants_gradient(x, weight, bias)
             ? Linear::apply(x, weight, if_defined(bias), false)
             : call_rows(x, weight, bias, false);
}

at::Tensor linear_autocast(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  const bool single = x.scalar_type() == at::kFloat && weight.scalar_type() == at::kFloat;
  if (!single) return linear(x, weight, bias);
  check_linear_args(x, weight, bias);
  if (wants_gradient(x, weight, bias)) return Linear::apply(x, weight, if_defined(bias), true);
  return linear_of_rows(x.reshape({-1, weight.size(1)}).contiguous(),
                        weight.to(at::kBFloat16).contiguous(), bias, x.sizes());
}

at::Tensor linear_gelu(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  check_linear_args(x, weight, bias);
  const bool in_one_pass = suits_rows(x, weight) && (weight.scalar_type() == at::kBFloat16 ||
                                                     !wants_gradient(x, weight, bias));
  return in_one_pass ? call_rows(x, weight, bias, true) : ops::gelu(linear(x, weight, bias));
}

}  // namespace lte::ops
