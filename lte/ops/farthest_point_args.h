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

}  // namespace lte::ops
