#include "lte/ops/curve_codes.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("curve_codes(Tensor cells, int curve, int bits=16) -> Tensor");
}

namespace lte::ops {

at::Tensor curve_codes(const at::Tensor& cells, Curve curve, int64_t bits) {
  using Signature = at::Tensor(const at::Tensor&, int64_t, int64_t);
  static const auto op = find_operator<Signature>("lte::curve_codes");
  return op.call(cells, static_cast<int64_t>(curve), bits);
}

}  // namespace lte::ops
