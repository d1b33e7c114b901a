#include "lte/ops/farthest_point.h"

#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/library.h>

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("farthest_point_sampling(Tensor points, int count) -> (Tensor, Tensor)");
}

namespace lte::ops {

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling(const at::Tensor& points,
                                                           int64_t count) {
  using Signature = std::tuple<at::Tensor, at::Tensor>(const at::Tensor&, int64_t);
  static const auto op = c10::Dispatcher::singleton()
                             .findSchemaOrThrow("lte::farthest_point_sampling", "")
                             .typed<Signature>();
  return op.call(points, count);
}

}  // namespace lte::ops
