#include "lte/nn/loss.h"

#include "lte/tensor/functions.h"

namespace lte::nn {

at::Tensor relative_loss(const at::Tensor& predicted, const at::Tensor& target,
                         const LossConfig& config) {
  TORCH_CHECK(predicted.sizes() == target.sizes(), "loss: predicted is ", predicted.sizes(),
              " but target is ", target.sizes());
  TORCH_CHECK(predicted.numel() > 0, "loss: no samples");
  TORCH_CHECK(config.epsilon > 0, "loss: epsilon must be positive, got ", config.epsilon);
  const bool logarithmic = config.space == LossSpace::Log;
  const at::Tensor got = logarithmic ? at::log1p(predicted) : predicted;
  const at::Tensor wanted = logarithmic ? at::log1p(target) : target;
  const at::Tensor denominator = (config.detach_denominator ? got.detach() : got) + config.epsilon;
  return ((got - wanted) / denominator).square().mean();
}

}  // namespace lte::nn
