// How far training has moved the weights of each part of the network.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/nn/model.h"

namespace lte::train {

class WeightMovement {
 public:
  /// Copies the weights of `start`. Those of two dimensions or more count: biases and norms begin
  /// at nought or one, and any movement is far from that.
  explicit WeightMovement(const nn::LightTransportModel& start);

  /// |w − w₀| / |w₀| of each module (gradient_module()), in the order of the network.
  std::vector<std::pair<std::string, double>> of(const nn::LightTransportModel& model) const;

 private:
  std::vector<at::Tensor> start_;  ///< in the order of the parameters, on the CPU
};

}  // namespace lte::train
