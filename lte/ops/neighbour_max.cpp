#include "lte/ops/neighbour_max.h"

#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/library.h>

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "neighbour_max_inference(Tensor dense, Tensor center, Tensor neighbour, Tensor weight, "
      "Tensor bias) -> Tensor");
}

namespace lte::ops {

at::Tensor neighbour_max_inference(const at::Tensor& dense, const at::Tensor& center,
                                   const at::Tensor& neighbour, const at::Tensor& weight,
                                   const at::Tensor& bias) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&,
                               const at::Tensor&, const at::Tensor&);
  static const auto op = c10::Dispatcher::singleton()
                             .findSchemaOrThrow("lte::neighbour_max_inference", "")
                             .typed<Signature>();
  return op.call(dense, center, neighbour, weight, bias);
}

}  // namespace lte::ops
