#include "lte/ops/knn.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("knn(Tensor queries, Tensor points, int k) -> (Tensor, Tensor)");
}

namespace lte::ops {

std::tuple<at::Tensor, at::Tensor> knn(const at::Tensor& queries, const at::Tensor& points,
                                       int64_t k) {
  static const auto op = find_operator<decltype(knn)>("lte::knn");
  return op.call(queries, points, k);
}

}  // namespace lte::ops
