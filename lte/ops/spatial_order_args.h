// What spatial_order() accepts.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

inline void check_spatial_order_args(const at::Tensor& points) {
  check_triples(points, at::kFloat, "spatial_order", "points");
  check_finite_rows(points, "spatial_order", "points");
}

}  // namespace lte::ops
