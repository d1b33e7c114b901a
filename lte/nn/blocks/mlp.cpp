#include "lte/nn/blocks/mlp.h"

#include <cmath>

#include "lte/ops/gelu.h"
#include "lte/tensor/module.h"

namespace lte::nn {

void initialize(Linear& linear, double gain) {
  const double scale = 1 / std::sqrt(static_cast<double>(linear->options.in_features()));
  torch::nn::init::normal_(linear->weight, 0, gain * scale);
  if (linear->bias.defined()) torch::nn::init::uniform_(linear->bias, -scale, scale);
}

MlpImpl::MlpImpl(int64_t inputs, int64_t hidden, int64_t outputs, double dropout,
                 double output_gain)
    : dropout_(dropout),
      hidden_(register_module("hidden", Linear(inputs, hidden))),
      output_(register_module("output", Linear(hidden, outputs))) {
  initialize(hidden_, std::sqrt(2.0));
  initialize(output_, output_gain);
}

at::Tensor MlpImpl::hidden_activations(const at::Tensor& x) {
  return hidden_->in_autocast() ? ops::gelu(hidden_->forward(x))
                                : ops::linear_gelu(x, hidden_->inference_weight(), hidden_->bias);
}

ops::PerceptronWeights MlpImpl::weights() const { return {hidden_->weights(), output_->weights()}; }

at::Tensor MlpImpl::forward(const at::Tensor& x) {
  if (!drops()) return output_->forward(hidden_activations(x));
  const at::Tensor hidden = at::dropout(hidden_activations(x), dropout_, true);
  return at::dropout(output_->forward(hidden), dropout_, true);
}

}  // namespace lte::nn
