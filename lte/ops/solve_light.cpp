#include "lte/ops/solve_light.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "solve_light(Tensor position, Tensor normal, Tensor albedo, Tensor emission, Tensor area) -> "
      "Tensor");
}

namespace lte::ops {

at::Tensor solve_light(const at::Tensor& position, const at::Tensor& normal,
                       const at::Tensor& albedo, const at::Tensor& emission,
                       const at::Tensor& area) {
  static const auto op = find_operator<decltype(solve_light)>("lte::solve_light");
  return op.call(position, normal, albedo, emission, area);
}

}  // namespace lte::ops
