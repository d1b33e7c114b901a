#include "lte/ops/norm_layers.h"

#include <tuple>
#include <vector>

#include <ATen/core/LegacyTypeDispatch.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/library.h>

#include "lte/ops/dispatch.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  // Weights: gain and bias of the norm, weight and bias of each layer. The gradients are those by x
  // and by each weight.
  m.def("norm_linear(Tensor x, Tensor[] weights) -> Tensor");
  m.def("norm_linear_backward(Tensor grad, Tensor x, Tensor[] weights) -> (Tensor, Tensor[])");
  m.def("feed_forward(Tensor x, Tensor[] weights) -> Tensor");
  m.def("project_feed_forward(Tensor x, Tensor attended, Tensor[] weights) -> Tensor");
  m.def("feed_forward_backward(Tensor grad, Tensor x, Tensor[] weights) -> (Tensor, Tensor[])");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;
using NormLayer = at::Tensor(const at::Tensor&, at::TensorList);
using NormLayerBackward = std::tuple<at::Tensor, std::vector<at::Tensor>>(const at::Tensor&,
                                                                          const at::Tensor&,
                                                                          at::TensorList);

at::Tensor call_layer(bool perceptron, const at::Tensor& x, at::TensorList weights) {
  static const auto linear = find_operator<NormLayer>("lte::norm_linear"),
                    feed = find_operator<NormLayer>("lte::feed_forward");
  return perceptron ? feed.call(x, weights) : linear.call(x, weights);
}

class TrainedNormLayer : public torch::autograd::Function<TrainedNormLayer> {
 public:
  static at::Tensor forward(AutogradContext* context, bool perceptron, const at::Tensor& x,
                            at::TensorList weights) {
    const at::AutoDispatchBelowADInplaceOrView below;
    variable_list saved = {x};
    saved.insert(saved.end(), weights.begin(), weights.end());
    context->save_for_backward(std::move(saved));
    context->saved_data["perceptron"] = perceptron;
    return call_layer(perceptron, x, weights);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    static const auto linear = find_operator<NormLayerBackward>("lte::norm_linear_backward"),
                      feed = find_operator<NormLayerBackward>("lte::feed_forward_backward");
    const variable_list saved = context->get_saved_variables();
    const at::TensorList weights = at::TensorList(saved).slice(1);
    const auto [by_x, by_weights] = context->saved_data["perceptron"].toBool()
                                        ? feed.call(grads[0], saved[0], weights)
                                        : linear.call(grads[0], saved[0], weights);
    variable_list out = {at::Tensor(), by_x};
    out.insert(out.end(), by_weights.begin(), by_weights.end());
    return out;
  }
};

std::vector<at::Tensor> list_of(const NormWeights& norm, const PerceptronWeights& perceptron) {
  return {norm.gain,
          norm.bias,
          perceptron.hidden.weight,
          perceptron.hidden.bias,
          perceptron.output.weight,
          perceptron.output.bias};
}

}  // namespace

at::Tensor norm_linear(const at::Tensor& x, const NormWeights& norm, const LinearWeights& linear) {
  const std::vector<at::Tensor> weights = {norm.gain, norm.bias, linear.weight, linear.bias};
  return TrainedNormLayer::apply(false, x, at::TensorList(weights));
}

at::Tensor feed_forward(const at::Tensor& x, const NormWeights& norm,
                        const PerceptronWeights& perceptron) {
  return TrainedNormLayer::apply(true, x, at::TensorList(list_of(norm, perceptron)));
}

at::Tensor project_feed_forward(const at::Tensor& x, const at::Tensor& attended,
                                const LinearWeights& projection, const NormWeights& norm,
                                const PerceptronWeights& perceptron) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, at::TensorList);
  static const auto op = find_operator<Signature>("lte::project_feed_forward");
  std::vector<at::Tensor> weights = list_of(norm, perceptron);
  weights.push_back(projection.weight);
  weights.push_back(projection.bias);
  const at::AutoDispatchBelowADInplaceOrView below;
  return op.call(x, attended, weights);
}

}  // namespace lte::ops
