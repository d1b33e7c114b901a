// What knn() accepts.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

inline void check_knn_points(const at::Tensor& points, int64_t k) {
  const char* op = "knn";
  check_triples(points, at::kFloat, op, "points");
  TORCH_CHECK(k >= 1, op, ": k must be at least 1, got ", k);
  check_finite_rows(points, op, "points");
}

inline void check_knn_queries(const at::Tensor& queries) {
  const char* op = "knn";
  check_triples(queries, at::kFloat, op, "queries");
  check_finite_rows(queries, op, "queries");
}

inline void check_knn_args(const at::Tensor& queries, const at::Tensor& points, int64_t k) {
  const char* op = "knn";
  check_knn_queries(queries);
  check_knn_points(points, k);
  TORCH_CHECK(points.size(0) >= 1 || queries.size(0) == 0, op, ": no points for ", queries.size(0),
              " queries");
  check_device(points, "points", queries, "queries", op);
}

}  // namespace lte::ops
