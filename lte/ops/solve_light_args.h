// What solve_light() accepts.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

inline void check_solve_light_args(const at::Tensor& position, const at::Tensor& normal,
                                   const at::Tensor& albedo, const at::Tensor& emission,
                                   const at::Tensor& area) {
  const char* op = "solve_light";
  check_triples(position, at::kFloat, op, "position");
  const int64_t M = position.size(0);
  const auto check = [&](const at::Tensor& t, const char* name) {
    check_triples(t, at::kFloat, op, name);
    check_shape(t, {M, 3}, at::kFloat, op, name);
    check_device(t, name, position, "positions", op);
    check_finite_rows(t, op, name);
  };
  check(position, "position");
  check(normal, "normal");
  check(albedo, "albedo");
  check(emission, "emission");
  check_shape(area, {M}, at::kFloat, op, "area");
  TORCH_CHECK(area.is_contiguous(), op, ": area must be contiguous");
  check_device(area, "area", position, "positions", op);
  if (!area.is_cpu()) return;
  const auto* areas = area.const_data_ptr<float>();
  const int64_t row = first_row(M, [&](int64_t i) { return !std::isfinite(areas[i]); });
  TORCH_CHECK(row == M, op, ": row ", row, " of area is not finite: ", areas[row]);
}

}  // namespace lte::ops
