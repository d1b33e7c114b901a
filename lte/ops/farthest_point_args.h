// What farthest_point_sampling() accepts.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

inline void check_farthest_point_args(const at::Tensor& points, int64_t count) {
  const char* op = "farthest_point_sampling";
  check_triples(points, at::kFloat, op, "points");
  TORCH_CHECK(count >= 0 && count <= points.size(0), op, ": count must be 0 to ", points.size(0),
              ", the number of points, got ", count);
  check_finite_rows(points, op, "points");
}

inline void check_farthest_point_sets(at::TensorList sets, at::IntArrayRef counts) {
  const char* op = "farthest_point_sampling_of_sets";
  TORCH_CHECK(sets.size() == counts.size(), op, ": ", counts.size(), " counts for ", sets.size(),
              " sets");
  for (size_t i = 0; i < sets.size(); ++i) {
    check_device(sets[i], "a set", sets[0], "the first", op);
    check_farthest_point_args(sets[i], counts[i]);
  }
}

}  // namespace lte::ops
