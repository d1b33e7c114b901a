#include "lte/ops/knn.h"

#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/library.h>

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("knn(Tensor queries, Tensor points, int k) -> (Tensor, Tensor)");
}

namespace lte::ops {

std::tuple<at::Tensor, at::Tensor> knn(const at::Tensor& queries, const at::Tensor& points,
                                       int64_t k) {
  using Signature =
      std::tuple<at::Tensor, at::Tensor>(const at::Tensor&, const at::Tensor&, int64_t);
  static const auto op =
      c10::Dispatcher::singleton().findSchemaOrThrow("lte::knn", "").typed<Signature>();
  return op.call(queries, points, k);
}

}  // namespace lte::ops
