#include "lte/ops/norm_layers.h"

#include <optional>
#include <tuple>
#include <vector>

#include "lte/ops/dispatch.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("layer_norm(Tensor x, Tensor gain, Tensor bias) -> Tensor");
  // Weights: gain and bias of the norm, weight and bias of each layer; the weights of layers may be
  // bfloat16. The gradients are those by x and by each weight, float32.
  m.def("norm_linear(Tensor x, Tensor[] weights) -> Tensor");
  m.def("norm_linear_backward(Tensor grad, Tensor x, Tensor[] weights) -> (Tensor, Tensor[])");
  // Weights: gain and bias of the norm, weight and bias of hidden layer, output and projection. The
  // gradients are those by x, by what is attended to, and by each weight.
  m.def("project_feed_forward(Tensor x, Tensor attended, Tensor[] weights) -> Tensor");
  m.def(
      "project_feed_forward_backward(Tensor grad, Tensor x, Tensor attended, Tensor[] weights) -> "
      "(Tensor, Tensor, Tensor[])");
  // Weights: weight and bias of the layer, gain and bias of the norm, and the share of the mean
  // that it subtracts, if any. The second result is what the layer gives.
  m.def(
      "linear_norm(Tensor x, Tensor? residual, Tensor[] weights, int[] counts) -> (Tensor, "
      "Tensor)");
  m.def(
      "linear_norm_backward(Tensor grad, Tensor x, Tensor product, Tensor[] weights, int[] counts) "
      "-> (Tensor, Tensor[])");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;
using Tensors = std::vector<at::Tensor>;

/// What a node saves: some tensors and the weights that products read.
variable_list joined(variable_list first, at::TensorList read) {
  first.insert(first.end(), read.begin(), read.end());
  return first;
}

/// A node's answer: gradients by the arguments before the weights, by the weights, and none by what
/// products read of these.
variable_list answer(variable_list first, const Tensors& by_weights) {
  first.insert(first.end(), by_weights.begin(), by_weights.end());
  first.resize(first.size() + by_weights.size());
  return first;
}

class NormLinear : public torch::autograd::Function<NormLinear> {
 public:
  /// @param read  what products read in the place of `weights`
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x,
                            at::TensorList /*weights*/, at::TensorList read) {
    const at::AutoDispatchBelowADInplaceOrView below;
    static const auto op =
        find_operator<at::Tensor(const at::Tensor&, at::TensorList)>("lte::norm_linear");
    context->save_for_backward(joined({x}, read));
    return op.call(x, read);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature =
        std::tuple<at::Tensor, Tensors>(const at::Tensor&, const at::Tensor&, at::TensorList);
    static const auto op = find_operator<Signature>("lte::norm_linear_backward");
    const variable_list saved = context->get_saved_variables();
    const auto [by_x, by_weights] = op.call(grads[0], saved[0], at::TensorList(saved).slice(1));
    return answer({by_x}, by_weights);
  }
};

class ProjectFeedForward : public torch::autograd::Function<ProjectFeedForward> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x,
                            const at::Tensor& attended, at::TensorList /*weights*/,
                            at::TensorList read) {
    using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, at::TensorList);
    const at::AutoDispatchBelowADInplaceOrView below;
    static const auto op = find_operator<Signature>("lte::project_feed_forward");
    context->save_for_backward(joined({x, attended}, read));
    return op.call(x, attended, read);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature = std::tuple<at::Tensor, at::Tensor, Tensors>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, at::TensorList);
    static const auto op = find_operator<Signature>("lte::project_feed_forward_backward");
    const variable_list saved = context->get_saved_variables();
    const auto [by_x, by_attended, by_weights] =
        op.call(grads[0], saved[0], saved[1], at::TensorList(saved).slice(2));
    return answer({by_x, by_attended}, by_weights);
  }
};

class LinearNorm : public torch::autograd::Function<LinearNorm> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x,
                            const std::optional<at::Tensor>& residual, at::TensorList /*weights*/,
                            at::TensorList read, const std::vector<int64_t>& counts) {
    using Signature = std::tuple<at::Tensor, at::Tensor>(
        const at::Tensor&, const std::optional<at::Tensor>&, at::TensorList, at::IntArrayRef);
    const at::AutoDispatchBelowADInplaceOrView below;
    static const auto op = find_operator<Signature>("lte::linear_norm");
    const auto [out, product] = op.call(x, residual, read, counts);
    context->save_for_backward(joined({x, product}, read));
    context->saved_data["counts"] = counts;
    context->saved_data["adds"] = residual.has_value();
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature = std::tuple<at::Tensor, Tensors>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, at::TensorList, at::IntArrayRef);
    static const auto op = find_operator<Signature>("lte::linear_norm_backward");
    const variable_list saved = context->get_saved_variables();
    const auto [by_x, by_weights] =
        op.call(grads[0], saved[0], saved[1], at::TensorList(saved).slice(2),
                context->saved_data["counts"].toIntVector());
    const bool adds = context->saved_data["adds"].toBool();
    variable_list out = answer({by_x, adds ? grads[0] : at::Tensor()}, by_weights);
    out.emplace_back();  // by the counts
    return out;
  }
};

/// Weights, and what products read of them.
struct LayerLists {
  Tensors weights, read;

  void add(const NormWeights& norm) {
    for (Tensors* list : {&weights, &read}) list->insert(list->end(), {norm.gain, norm.bias});
  }
  void add(const LinearWeights& layer) {
    weights.insert(weights.end(), {layer.weight, layer.bias});
    read.insert(read.end(), {layer.as_read(), layer.bias});
  }
};

constexpr double kEpsilon = 1e-5;  // as the kernels have it

}  // namespace

at::Tensor layer_norm(const at::Tensor& x, const NormWeights& norm) {
  if (!suits_norm_layers(x) || x.dim() != 2 || at::GradMode::is_enabled())
    return at::layer_norm(x, {x.size(-1)}, norm.gain, norm.bias, kEpsilon);
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&);
  static const auto op = find_operator<Signature>("lte::layer_norm");
  return op.call(x, norm.gain, norm.bias);
}

at::Tensor norm_linear(const at::Tensor& x, const NormWeights& norm, const LinearWeights& linear) {
  LayerLists lists;
  lists.add(norm);
  lists.add(linear);
  return NormLinear::apply(x, at::TensorList(lists.weights), at::TensorList(lists.read));
}

at::Tensor project_feed_forward(const at::Tensor& x, const at::Tensor& attended,
                                const LinearWeights& projection, const NormWeights& norm,
                                const PerceptronWeights& perceptron) {
  LayerLists lists;
  lists.add(norm);
  lists.add(perceptron.hidden);
  lists.add(perceptron.output);
  lists.add(projection);
  return ProjectFeedForward::apply(x, attended, at::TensorList(lists.weights),
                                   at::TensorList(lists.read));
}

at::Tensor linear_norm(const at::Tensor& x, const LinearWeights& linear, const CenteredNorm& norm,
                       const std::vector<int64_t>& counts, const at::Tensor& residual) {
  LayerLists lists;
  lists.add(linear);
  lists.add(norm.norm);
  if (norm.share.defined()) {
    for (Tensors* list : {&lists.weights, &lists.read}) list->push_back(norm.share);
  }
  return LinearNorm::apply(x, residual.defined() ? std::optional(residual) : std::nullopt,
                           at::TensorList(lists.weights), at::TensorList(lists.read), counts);
}

}  // namespace lte::ops
