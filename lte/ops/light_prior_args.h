// What light_prior_means() accepts.
#pragma once

#include "lte/ops/arguments.h"
#include "lte/ops/light_prior.h"

namespace lte::ops {

/// [rows, columns] float32 on the CPU.
inline void check_columns(const at::Tensor& t, int64_t rows, int64_t columns, const char* op,
                          const char* name) {
  TORCH_CHECK(t.is_cpu() && t.scalar_type() == at::kFloat && t.dim() == 2 && t.size(0) == rows &&
                  t.size(1) == columns,
              op, ": ", name, " must be [", rows, ", ", columns, "] float32 on the CPU, got ",
              t.sizes(), " ", t.scalar_type(), " on ", t.device());
}

inline void check_light_prior_args(const at::Tensor& position, const at::Tensor& normal,
                                   const at::Tensor& points, const at::Tensor& normals,
                                   const at::Tensor& light, const at::Tensor& errors,
                                   const at::Tensor& index) {
  const char* op = "light_prior_means";
  TORCH_CHECK(position.dim() == 2 && points.dim() == 2, op,
              ": position and points must be [., 3], got ", position.sizes(), " and ",
              points.sizes());
  const int64_t Q = position.size(0), S = points.size(0);
  check_columns(position, Q, 3, op, "position");
  check_columns(normal, Q, 3, op, "normal");
  check_columns(points, S, 3, op, "points");
  check_columns(normals, S, 6, op, "normals");
  check_columns(light, S, 2 * kPriorLight, op, "light");
  if (errors.defined()) check_columns(errors, S, 2, op, "errors");
  check_device(index, "indices", position, "positions", op);
  check_neighbours(index, Q, S, op);
  const int64_t K = index.size(1);
  TORCH_CHECK(K >= 1 && K <= kMaxPriorNeighbours, op, ": 1 to ", kMaxPriorNeighbours,
              " neighbours, got ", K);
}

}  // namespace lte::ops
