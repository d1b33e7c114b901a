// What patch_attention() and its kin accept.
#pragma once

#include <optional>

#include "lte/ops/arguments.h"
#include "lte/ops/patch_attention.h"

namespace lte::ops {

/// int64 indices in [0, limit), on the CPU.
inline void check_slots(const at::Tensor& t, int64_t limit, const char* op, const char* name) {
  TORCH_CHECK(t.dim() == 1 && t.scalar_type() == at::kLong && t.is_cpu(), op, ": ", name,
              " must be one-dimensional int64 on the CPU, got ", t.sizes(), " ", t.scalar_type(),
              " on ", t.device());
  const at::Tensor dense = t.contiguous();
  const auto* slot = dense.const_data_ptr<int64_t>();
  const int64_t bad =
      first_row(t.size(0), [&](int64_t i) { return slot[i] < 0 || slot[i] >= limit; });
  TORCH_CHECK(bad == t.size(0), op, ": entry ", bad, " of ", name, " is ", slot[bad],
              ", outside [0, ", limit, ")");
}

inline void check_patch_attention_args(const char* op, const at::Tensor& qkv,
                                       const std::optional<at::Tensor>& gather,
                                       const std::optional<at::Tensor>& inverse, int64_t heads,
                                       int64_t patch) {
  TORCH_CHECK(qkv.dim() == 2 && qkv.scalar_type() == at::kFloat && heads >= 1 &&
                  qkv.size(1) % (3 * heads) == 0,
              op, ": qkv must be [n, 3C] float32 with C divided by ", heads, " heads, got ",
              qkv.sizes(), " ", qkv.scalar_type());
  TORCH_CHECK(gather.has_value() == inverse.has_value(), op, ": gather and inverse go together");
  const int64_t n = qkv.size(0), width = qkv.size(1) / 3 / heads;
  TORCH_CHECK(width <= kWidestHead, op, ": heads of ", width, " channels, the most is ",
              kWidestHead);
  if (!gather.has_value()) return;
  TORCH_CHECK(patch >= 1 && gather->numel() % patch == 0, op, ": ", gather->numel(),
              " slots are no whole patches of ", patch);
  TORCH_CHECK(inverse->numel() == n, op, ": inverse must be [", n, "], got ", inverse->sizes());
  check_slots(*gather, n, op, "gather");
  check_slots(*inverse, gather->numel(), op, "inverse");
}

/// What patch_attention() returned, contiguous, and the gradient by the first of it.
inline void check_patch_attention_backward_args(const at::Tensor& grad, const at::Tensor& out,
                                                const at::Tensor& log_sum, int64_t slots,
                                                const at::Tensor& qkv, int64_t heads) {
  const char* op = "patch_attention_backward";
  const int64_t n = qkv.size(0), C = qkv.size(1) / 3;
  const auto is = [](const at::Tensor& t, int64_t rows, int64_t columns) {
    return t.dim() == 2 && t.size(0) == rows && t.size(1) == columns && t.is_cpu() &&
           t.scalar_type() == at::kFloat && t.is_contiguous();
  };
  TORCH_CHECK(is(grad, n, C) && is(out, n, C), op, ": grad and out must be [", n, ", ", C,
              "] float32, got ", grad.sizes(), " ", grad.scalar_type(), " and ", out.sizes(), " ",
              out.scalar_type());
  TORCH_CHECK(is(log_sum, slots, heads), op, ": log_sum must be [", slots, ", ", heads,
              "] float32, got ", log_sum.sizes(), " ", log_sum.scalar_type());
}

}  // namespace lte::ops
