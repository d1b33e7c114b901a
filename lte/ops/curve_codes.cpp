#include "lte/ops/curve_codes.h"

#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/library.h>

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("curve_codes(Tensor cells, int curve, int bits=16) -> Tensor");
}

namespace lte::ops {

at::Tensor curve_codes(const at::Tensor& cells, Curve curve, int64_t bits) {
  static const auto op = c10::Dispatcher::singleton()
                             .findSchemaOrThrow("lte::curve_codes", "")
                             .typed<at::Tensor(const at::Tensor&, int64_t, int64_t)>();
  return op.call(cells, static_cast<int64_t>(curve), bits);
}

}  // namespace lte::ops
