#include "lte/ops/farthest_point.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def("farthest_point_sampling(Tensor points, int count) -> (Tensor, Tensor)");
  m.def("farthest_point_sampling_of_sets(Tensor[] sets, int[] counts) -> (Tensor[], Tensor[])");
}

namespace lte::ops {

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling(const at::Tensor& points,
                                                           int64_t count) {
  static const auto op =
      find_operator<decltype(farthest_point_sampling)>("lte::farthest_point_sampling");
  return op.call(points, count);
}

std::tuple<std::vector<at::Tensor>, std::vector<at::Tensor>> farthest_point_sampling_of_sets(
    at::TensorList sets, at::IntArrayRef counts) {
  static const auto op = find_operator<decltype(farthest_point_sampling_of_sets)>(
      "lte::farthest_point_sampling_of_sets");
  return op.call(sets, counts);
}

}  // namespace lte::ops
