#include "lte/ops/query_decoder.h"

#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/library.h>

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "query_decoder_inference(Tensor attributes, Tensor position, Tensor anchor, Tensor index, "
      "float scale, float limit, Tensor table, Tensor[] weights) -> Tensor");
  m.def("spatial_order(Tensor points) -> Tensor");
}

namespace lte::ops {

at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, at::TensorList weights) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&, double,
                 double, const at::Tensor&, at::TensorList);
  static const auto op = c10::Dispatcher::singleton()
                             .findSchemaOrThrow("lte::query_decoder_inference", "")
                             .typed<Signature>();
  return op.call(attributes, near.position, near.anchor, near.index, near.scale, near.limit, table,
                 weights);
}

at::Tensor spatial_order(const at::Tensor& points) {
  static const auto op = c10::Dispatcher::singleton()
                             .findSchemaOrThrow("lte::spatial_order", "")
                             .typed<at::Tensor(const at::Tensor&)>();
  return op.call(points);
}

}  // namespace lte::ops
