#include "lte/ops/neighbour_max.h"

#include <torch/library.h>

#include "lte/ops/dispatch.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "neighbour_max_inference(Tensor dense, Tensor center, Tensor neighbour, Tensor weight, "
      "Tensor bias) -> Tensor");
}

namespace lte::ops {

at::Tensor neighbour_max_inference(const at::Tensor& dense, const at::Tensor& center,
                                   const at::Tensor& neighbour, const at::Tensor& weight,
                                   const at::Tensor& bias) {
  static const auto op =
      find_operator<decltype(neighbour_max_inference)>("lte::neighbour_max_inference");
  return op.call(dense, center, neighbour, weight, bias);
}

}  // namespace lte::ops
