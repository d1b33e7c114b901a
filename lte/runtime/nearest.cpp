#include "lte/runtime/nearest.h"

#include "lte/ops/knn.h"
#include "lte/runtime/tensors.h"
#include "lte/runtime/torch_errors.h"

namespace lte::runtime {

std::vector<int64_t> nearest_points(std::span<const Vec3> queries, std::span<const Vec3> points) {
  if (queries.empty()) return {};
  return own_errors([&] {
    const at::Tensor index = std::get<0>(ops::knn(borrow(queries), borrow(points), 1));
    const auto* first = index.const_data_ptr<int64_t>();
    return std::vector<int64_t>(first, first + index.numel());
  });
}

}  // namespace lte::runtime
