// What rotate_heads() accepts.
#pragma once

#include "lte/ops/arguments.h"

namespace lte::ops {

inline void check_rotate_heads_args(const at::Tensor& qkv, const at::Tensor& cosine,
                                    const at::Tensor& sine, int64_t heads) {
  const char* op = "rotate_heads";
  TORCH_CHECK(qkv.dim() == 2 && at::isFloatingType(qkv.scalar_type()) && heads >= 1 &&
                  qkv.size(1) % (6 * heads) == 0,
              op, ": qkv must be [n, 3C] floating point with C divided by 2 x ", heads,
              " heads, got ", qkv.sizes(), " ", qkv.scalar_type());
  const int64_t n = qkv.size(0), pairs = qkv.size(1) / (6 * heads);
  check_shape(cosine, {n, pairs}, at::kFloat, op, "cosine");
  check_shape(sine, {n, pairs}, at::kFloat, op, "sine");
  check_device(cosine, "the cosines", qkv, "qkv", op);
  check_device(sine, "the sines", qkv, "qkv", op);
}

}  // namespace lte::ops
