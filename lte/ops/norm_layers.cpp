#include "lte/ops/norm_layers.h"

#include <tuple>
#include <vector>

#include <ATen/core/LegacyTypeDispatch.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/library.h>

#include "lte/ops/dispatch.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  // Weights: gain and bias of the norm, weight and bias of each layer; the weights of layers may be
  // bfloat16. The gradients are those by x and by each weight, float32.
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
  /// @param read  what products read in the place of `weights`
  static at::Tensor forward(AutogradContext* context, bool perceptron, const at::Tensor& x,
                            at::TensorList /*weights*/, at::TensorList read) {
    const at::AutoDispatchBelowADInplaceOrView below;
    variable_list saved = {x};
    saved.insert(saved.end(), read.begin(), read.end());
    context->save_for_backward(std::move(saved));
    context->saved_data["perceptron"] = perceptron;
    return call_layer(perceptron, x, read);
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    static const auto linear = find_operator<NormLayerBackward>("lte::norm_linear_backward"),
                      feed = find_operator<NormLayerBackward>("lte::feed_forward_backward");
    const variable_list saved = context->get_saved_variables();
    const at::TensorList read = at::TensorList(saved).slice(1);
    const auto [by_x, by_weights] = context->saved_data["perceptron"].toBool()
                                        ? feed.call(grads[0], saved[0], read)
                                        : linear.call(grads[0], saved[0], read);
    variable_list out = {at::Tensor(), by_x};
    out.insert(out.end(), by_weights.begin(), by_weights.end());
    out.resize(out.size() + read.size());
    return out;
  }
};

/// Weights of a norm and what follows it, and what products read of them.
struct LayerLists {
  std::vector<at::Tensor> weights, read;

  LayerLists(const NormWeights& norm, const std::vector<LinearWeights>& layers)
      : weights{norm.gain, norm.bias}, read(weights) {
    for (const LinearWeights& layer : layers) {
      weights.insert(weights.end(), {layer.weight, layer.bias});
      read.insert(read.end(), {layer.as_read(), layer.bias});
    }
  }

  at::Tensor apply(bool perceptron, const at::Tensor& x) const {
    return TrainedNormLayer::apply(perceptron, x, at::TensorList(weights), at::TensorList(read));
  }
};

}  // namespace

at::Tensor norm_linear(const at::Tensor& x, const NormWeights& norm, const LinearWeights& linear) {
  return LayerLists(norm, {linear}).apply(false, x);
}

at::Tensor feed_forward(const at::Tensor& x, const NormWeights& norm,
                        const PerceptronWeights& perceptron) {
  return LayerLists(norm, {perceptron.hidden, perceptron.output}).apply(true, x);
}

at::Tensor project_feed_forward(const at::Tensor& x, const at::Tensor& attended,
                                const LinearWeights& projection, const NormWeights& norm,
                                const PerceptronWeights& perceptron) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, at::TensorList);
  static const auto op = find_operator<Signature>("lte::project_feed_forward");
  const LayerLists lists(norm, {perceptron.hidden, perceptron.output, projection});
  const at::AutoDispatchBelowADInplaceOrView below;
  return op.call(x, attended, lists.read);
}

}  // namespace lte::ops
