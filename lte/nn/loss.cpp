#include "lte/nn/loss.h"

#include <ATen/ATen.h>

namespace lte::nn {

at::Tensor log_relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                             const LossConfig& config) {
  TORCH_CHECK(predicted.sizes() == target.sizes(), "loss: predicted is ", predicted.sizes(),
              " but target is ", target.sizes());
  TORCH_CHECK(predicted.numel() > 0, "loss: no samples");
  TORCH_CHECK(config.epsilon > 0, "loss: epsilon must be positive, got ", config.epsilon);
  const at::Tensor log_predicted = at::log1p(predicted);
  const at::Tensor denominator =
      (config.detach_denominator ? log_predicted.detach() : log_predicted) + config.epsilon;
  return ((log_predicted - at::log1p(target)) / denominator).square().mean();
}

}  // namespace lte::nn
