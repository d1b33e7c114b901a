// Two-layer perceptrons and the initialization that all linear layers of the network share.
#pragma once

#include <cstdint>

#include "lte/nn/blocks/linear.h"
#include "lte/ops/decoder_weights.h"

namespace lte::nn {

/// Weights from N(0, gain² / inputs), biases from U(±1/sqrt(inputs)), so that inputs of unit
/// variance leave with variance gain² and the kinks of a hidden layer lie at different places.
void initialize(Linear& linear, double gain);

/// Linear(inputs -> hidden), GELU, Linear(hidden -> outputs), with dropout after either layer while
/// training. Parameters: `hidden.{weight,bias}`, `output.{weight,bias}`.
class MlpImpl : public torch::nn::Module {
 public:
  /// @param output_gain  of the last layer; the first has sqrt(2), which GELU halves
  MlpImpl(int64_t inputs, int64_t hidden, int64_t outputs, double dropout = 0,
          double output_gain = 1);

  /// @param x  [..., inputs]
  /// @return   [..., outputs]
  at::Tensor forward(const at::Tensor& x);

  /// GELU of the first layer, [..., hidden]: for callers that fuse the second.
  at::Tensor hidden_activations(const at::Tensor& x);

  /// Both layers as fused operators read them.
  ops::PerceptronWeights weights() const;

  /// Whether it drops out numbers, as it does while training, if asked to.
  bool drops() const { return is_training() && dropout_ > 0; }
  bool in_autocast() const { return hidden_->in_autocast(); }

  Linear& hidden() { return hidden_; }
  Linear& output() { return output_; }

 private:
  double dropout_;
  Linear hidden_{nullptr}, output_{nullptr};
};
TORCH_MODULE(Mlp);

}  // namespace lte::nn
