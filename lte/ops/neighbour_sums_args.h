// What the neighbour sums, their gradients and their tables accept.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

/// Channels of a block of neighbour_table()'s layout on the CPU.
inline constexpr int64_t kTableBlock = 16;

/// Numbers after each latent there, a cache line: without them a block of channels of all latents
/// falls into few sets of the first-level cache where C is a power of two, and drives itself out.
inline constexpr int64_t kTableGap = kTableBlock;

/// What a table says of itself.
struct TableSizes {
  int64_t layers, latents;
};

/// `table` is one of neighbour_table() for C channels: [m, ⌈C / kTableBlock⌉, L, 2, kTableBlock] on
/// the CPU, where only the first axis may have gaps; [2, L, m, C] on CUDA; float32.
inline TableSizes check_table(const at::Tensor& table, int64_t C, const char* op) {
  const bool blocked = table.dim() == 5 && table.size(1) == (C + kTableBlock - 1) / kTableBlock &&
                       table.size(3) == 2 && table.size(4) == kTableBlock;
  const bool stacked = table.dim() == 4 && table.size(0) == 2 && table.size(3) == C;
  TORCH_CHECK((table.is_cpu() ? blocked : stacked) && table.scalar_type() == at::kFloat &&
                  (table.is_cpu() ? table.size(0) == 0 || table.select(0, 0).is_contiguous()
                                  : table.is_contiguous()),
              op, ": table must come from neighbour_table() at C = ", C, " in float32, got ",
              table.sizes(), " ", table.scalar_type());
  if (table.is_cpu()) return {table.size(2), table.size(0)};
  return {table.size(1), table.size(2)};
}

inline void check_neighbour_table_args(const at::Tensor& keys, const at::Tensor& values,
                                       const char* op = "neighbour_table") {
  TORCH_CHECK(keys.dim() == 3, op, ": keys must be [L, m, C], got ", keys.sizes());
  TORCH_CHECK(values.sizes() == keys.sizes(), op, ": values must have the shape of keys, ",
              keys.sizes(), ", got ", values.sizes());
  TORCH_CHECK((keys.scalar_type() == at::kFloat || keys.scalar_type() == at::kDouble) &&
                  values.scalar_type() == keys.scalar_type(),
              op, ": keys and values must both be float32 or float64, got ", keys.scalar_type(),
              " and ", values.scalar_type());
  check_device(values, "values", keys, "keys", op);
}

inline void check_neighbour_sums_args(const at::Tensor& keys, const at::Tensor& values,
                                      const at::Tensor& position, const at::Tensor& index,
                                      const char* op = "neighbour_sums") {
  check_neighbour_table_args(keys, values, op);
  TORCH_CHECK(index.dim() == 2, op, ": index must be [Q, K] int64, got ", index.sizes());
  check_neighbours(index, index.size(0), keys.size(1), op);
  check_shape(position, {index.size(0), index.size(1), keys.size(2)}, keys.scalar_type(), op,
              "position");
  check_device(index, "indices", keys, "keys", op);
  check_device(position, "positions", keys, "keys", op);
}

inline void check_neighbour_sums_backward_args(const at::Tensor& grad1, const at::Tensor& grad2,
                                               const at::Tensor& keys, const at::Tensor& values,
                                               const at::Tensor& position,
                                               const at::Tensor& index) {
  const char* op = "neighbour_sums_backward";
  check_neighbour_sums_args(keys, values, position, index, op);
  for (const at::Tensor& grad : {grad1, grad2}) {
    check_shape(grad, {keys.size(0), index.size(0), keys.size(2)}, keys.scalar_type(), op,
                "a gradient");
    check_device(grad, "gradients", keys, "keys", op);
  }
}

inline TableSizes check_neighbour_sums_inference_args(const at::Tensor& table,
                                                      const at::Tensor& hidden,
                                                      const at::Tensor& weight,
                                                      const at::Tensor& bias,
                                                      const at::Tensor& index) {
  const char* op = "neighbour_sums_inference";
  TORCH_CHECK(weight.dim() == 2 && bias.dim() == 1 && bias.size(0) == weight.size(0), op,
              ": weight must be [C, H] and bias [C], got ", weight.sizes(), " and ", bias.sizes());
  const TableSizes sizes = check_table(table, weight.size(0), op);
  TORCH_CHECK(index.dim() == 2, op, ": index must be [Q, K] int64, got ", index.sizes());
  check_neighbours(index, index.size(0), sizes.latents, op);
  TORCH_CHECK(hidden.dim() == 3 && hidden.size(0) == index.size(0) &&
                  hidden.size(1) == index.size(1) && hidden.size(2) == weight.size(1),
              op, ": hidden must be [", index.size(0), ", ", index.size(1), ", ", weight.size(1),
              "], got ", hidden.sizes());
  for (const at::Tensor& t : {hidden, weight, bias}) {
    TORCH_CHECK(t.scalar_type() == at::kFloat, op,
                ": hidden, weight and bias must be float32, got ", t.scalar_type());
    check_device(t, "hidden activations, weight and bias", table, "tables", op);
  }
  check_device(index, "indices", table, "tables", op);
  return sizes;
}

}  // namespace lte::ops
