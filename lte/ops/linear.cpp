#include "lte/ops/linear.h"

#include <optional>
#include <string_view>
#include <vector>

#include <ATen/Context.h>
#include <ATen/core/List.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/mm.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/library.h>

#include "lte/ops/dispatch.h"
#include "lte/ops/gelu.h"
#include "lte/ops/linear_args.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("linear_bf16(Tensor x, Tensor weight, Tensor? bias, bool gelu) -> Tensor");
  // gradᵀ x: grad [N, O] float32, x [N, C] bfloat16 -> [O, C] float32.
  m.def("weight_gradient_bf16(Tensor grad, Tensor x) -> Tensor");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// Multiply-adds below which the call into oneDNN costs more than it gains, as measured: in the
/// forward pass and the gradient by the input, and in the gradient by the weight, where both
/// factors are transposed.
constexpr int64_t kLeastForward = int64_t{1} << 20, kLeastByWeight = int64_t{1} << 22;

using FusedLinear = at::Tensor(const at::Tensor&, const at::Tensor&,
                               const std::optional<at::Tensor>&, std::string_view,
                               c10::List<std::optional<at::Scalar>>,
                               std::optional<std::string_view>);

/// oneDNN's linear on plain tensors, which LibTorch's own compiler emits. Absent in builds without
/// oneDNN, and one day perhaps in LibTorch: all products then go to ATen.
const std::optional<c10::TypedOperatorHandle<FusedLinear>>& fused_linear() {
  static const auto op = [] {
    std::optional<c10::TypedOperatorHandle<FusedLinear>> typed;
    const auto found = c10::Dispatcher::singleton().findSchema({"mkldnn::_linear_pointwise", ""});
    if (!found || !at::hasMKLDNN()) return typed;
    try {
      typed = found->typed<FusedLinear>();
    } catch (const c10::Error&) {
      // Another signature than the one known here: as if it were not there.
    }
    return typed;
  }();
  return op;
}

bool suits_fused(const at::Tensor& x, const at::Tensor& weight, int64_t least) {
  return x.device().is_cpu() && x.scalar_type() == at::kFloat &&
         weight.scalar_type() == at::kFloat && x.dim() >= 2 && weight.dim() == 2 &&
         x.size(-1) == weight.size(1) && x.numel() * weight.size(0) >= least &&
         at::globalContext().userEnabledMkldnn() && fused_linear().has_value();
}

std::optional<at::Tensor> if_defined(const at::Tensor& t) {
  return t.defined() ? std::optional(t) : std::nullopt;
}

/// Rows or columns without gaps: oneDNN multiplies others by its slow reference code.
at::Tensor dense(const at::Tensor& t) {
  return t.dim() == 2 && t.t().is_contiguous() ? t : t.contiguous();
}

at::Tensor call_fused(const at::Tensor& x, const at::Tensor& weight,
                      const std::optional<at::Tensor>& bias, bool gelu) {
  return fused_linear()->call(dense(x), dense(weight), bias, gelu ? "gelu" : "none",
                              c10::List<std::optional<at::Scalar>>(), gelu ? "none" : "");
}

/// float32 rows, bfloat16 weights.
bool mixes_bf16(const at::Tensor& x, const at::Tensor& weight) {
  return x.scalar_type() == at::kFloat && weight.scalar_type() == at::kBFloat16;
}

at::Tensor call_bf16(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias,
                     bool gelu) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const std::optional<at::Tensor>&, bool);
  static const auto op = find_operator<Signature>("lte::linear_bf16");
  return op.call(x, weight, if_defined(bias), gelu);
}

/// a Bᵀ without bias; any strides.
at::Tensor product(const at::Tensor& a, const at::Tensor& b, int64_t least) {
  return suits_fused(a, b, least) ? call_fused(a, b, std::nullopt, false) : at::mm(a, b.t());
}

class Linear : public torch::autograd::Function<Linear> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x, const at::Tensor& weight,
                            const std::optional<at::Tensor>& bias) {
    const at::AutoDispatchBelowADInplaceOrView below;
    context->save_for_backward({x, weight});
    context->saved_data["has_bias"] = bias.has_value();
    return call_fused(x, weight, bias, false);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    const at::Tensor &x = saved[0], &weight = saved[1];
    const at::Tensor grad = grads[0].reshape({-1, weight.size(0)});
    variable_list out(3);
    if (context->needs_input_grad(0)) {
      out[0] = product(grad, weight.t(), kLeastForward).view(x.sizes());
    }
    if (context->needs_input_grad(1)) {
      const at::Tensor rows = x.reshape({-1, weight.size(1)});
      out[1] = product(grad.t(), rows.t(), kLeastByWeight);
    }
    // Counted over tensors: without a bias there is no third.
    if (context->saved_data["has_bias"].toBool() && context->needs_input_grad(2)) {
      out[2] = grad.sum(0);
    }
    return out;
  }
};

/// x Wᵀ + b in float32 for an x of `x_sizes`, given as float32 rows, and W [O, C] bfloat16.
at::Tensor rounded_linear(const at::Tensor& rows, const at::Tensor& weight, const at::Tensor& bias,
                          at::IntArrayRef x_sizes) {
  std::vector<int64_t> sizes = x_sizes.vec();
  sizes.back() = weight.size(0);
  return call_bf16(rows, weight, bias, false).view(sizes);
}

/// gradᵀ x in float32, grad [N, O] being float32 and x [N, C] bfloat16.
at::Tensor rounded_weight_gradient(const at::Tensor& grad, const at::Tensor& x) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&);
  static const auto op = find_operator<Signature>("lte::weight_gradient_bf16");
  return op.call(grad, x);
}

class AutocastLinear : public torch::autograd::Function<AutocastLinear> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x, const at::Tensor& weight,
                            const std::optional<at::Tensor>& bias) {
    const at::AutoDispatchBelowADInplaceOrView below;
    const at::Tensor rows = x.reshape({-1, weight.size(1)}).contiguous();
    const at::Tensor half = weight.to(at::kBFloat16).contiguous();
    context->save_for_backward({rows.to(at::kBFloat16), half});
    context->saved_data["sizes"] = x.sizes();
    context->saved_data["has_bias"] = bias.has_value();
    return rounded_linear(rows, half, bias.value_or(at::Tensor()), x.sizes());
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    const at::Tensor &x = saved[0], &weight = saved[1];
    const at::Tensor grad = grads[0].reshape({-1, weight.size(0)}).contiguous();
    variable_list out(3);
    if (context->needs_input_grad(0)) {
      out[0] = call_bf16(grad, weight.t().contiguous(), {}, false)
                   .view(context->saved_data["sizes"].toIntVector());
    }
    if (context->needs_input_grad(1)) out[1] = rounded_weight_gradient(grad, x);
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
  if (mixes_bf16(x, weight)) return call_bf16(x, weight, bias, false);
  if (!suits_fused(x, weight, kLeastForward)) return at::linear(x, weight, if_defined(bias));
  const std::optional<at::Tensor> offset = if_defined(bias);
  return wants_gradient(x, weight, bias) ? Linear::apply(x, weight, offset)
                                         : call_fused(x, weight, offset, false);
}

at::Tensor linear_autocast(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  const bool single = x.scalar_type() == at::kFloat && weight.scalar_type() == at::kFloat;
  if (!single) return linear(x, weight, bias);
  check_linear_args(x, weight, bias);
  if (wants_gradient(x, weight, bias)) return AutocastLinear::apply(x, weight, if_defined(bias));
  return rounded_linear(x.reshape({-1, weight.size(1)}).contiguous(),
                        weight.to(at::kBFloat16).contiguous(), bias, x.sizes());
}

at::Tensor linear_gelu(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias) {
  check_linear_args(x, weight, bias);
  if (mixes_bf16(x, weight)) return call_bf16(x, weight, bias, true);
  const bool fused = suits_fused(x, weight, kLeastForward) && !wants_gradient(x, weight, bias);
  return fused ? call_fused(x, weight, if_defined(bias), true) : ops::gelu(linear(x, weight, bias));
}

}  // namespace lte::ops
