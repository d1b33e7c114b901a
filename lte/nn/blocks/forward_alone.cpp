// Recomputation where nothing is differentiated: builds without LibTorch.
#include "lte/nn/blocks/recompute.h"

namespace lte::nn {

bool is_differentiated() { return false; }

std::vector<at::Tensor> recompute(TensorFunction function, const std::vector<at::Tensor>& inputs,
                                  const std::vector<at::Tensor>& /*parameters*/) {
  return function(inputs);
}

}  // namespace lte::nn
