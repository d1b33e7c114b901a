#include "lte/ops/spatial_order.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) { m.def("spatial_order(Tensor points) -> Tensor"); }

namespace lte::ops {

at::Tensor spatial_order(const at::Tensor& points) {
  static const auto op = find_operator<decltype(spatial_order)>("lte::spatial_order");
  return op.call(points);
}

}  // namespace lte::ops
