// What neighbour_max_inference() accepts.
#pragma once

#include "lte/ops/arguments.h"
#include "lte/ops/neighbour_max.h"

namespace lte::ops {

inline void check_neighbour_max_args(const at::Tensor& dense, const at::Tensor& center,
                                     const at::Tensor& neighbour, const at::Tensor& weight,
                                     const at::Tensor& bias,
                                     const char* op = "neighbour_max_inference") {
  TORCH_CHECK(weight.dim() == 2 && bias.dim() == 1 && bias.size(0) == weight.size(0), op,
              ": weight must be [O, C] and bias [O], got ", weight.sizes(), " and ", bias.sizes());
  for (const at::Tensor& t : {dense, center}) {
    TORCH_CHECK(t.dim() == 2 && t.size(1) == weight.size(1), op, ": dense and center must be [., ",
                weight.size(1), "], got ", t.sizes());
  }
  TORCH_CHECK(weight.scalar_type() == at::kFloat || weight.scalar_type() == at::kBFloat16, op,
              ": weight must be float32 or bfloat16, got ", weight.scalar_type());
  for (const at::Tensor& t : {dense, center, bias}) {
    TORCH_CHECK(t.scalar_type() == at::kFloat, op, ": dense, center and bias must be float32, got ",
                t.scalar_type());
  }
  check_neighbours(neighbour, center.size(0), dense.size(0), op);
  TORCH_CHECK(neighbour.size(1) >= 1, op, ": a maximum over no neighbours");
}

/// The same, as the gradients need it.
inline void check_neighbour_max_training_args(const at::Tensor& dense, const at::Tensor& center,
                                              const at::Tensor& neighbour, const at::Tensor& weight,
                                              const at::Tensor& bias) {
  const char* op = "neighbour_max";
  check_neighbour_max_args(dense, center, neighbour, weight, bias, op);
  TORCH_CHECK(weight.size(1) % kMaximumBlock == 0, op, ": weight must have inputs in multiples of ",
              kMaximumBlock, ", got ", weight.sizes());
}

inline void check_neighbour_max_backward_args(const at::Tensor& grad, const at::Tensor& dense,
                                              const at::Tensor& center, const at::Tensor& neighbour,
                                              const at::Tensor& weight, const at::Tensor& winner) {
  const char* op = "neighbour_max_backward";
  check_neighbour_max_training_args(dense, center, neighbour, weight,
                                    weight.select(1, 0).to(at::kFloat));
  check_shape(grad, {center.size(0), weight.size(0)}, at::kFloat, op, "grad");
  check_shape(winner, {center.size(0), weight.size(0)}, at::kInt, op, "winner");
}

}  // namespace lte::ops
