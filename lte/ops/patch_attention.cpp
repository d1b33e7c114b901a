#include "lte/ops/patch_attention.h"

#include <optional>

#include <torch/library.h>

#include "lte/ops/dispatch.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "patch_attention_inference(Tensor qkv, Tensor? gather, Tensor? inverse, int heads, int "
      "patch, bool bf16=False) -> Tensor");
}

namespace lte::ops {

at::Tensor patch_attention_inference(const at::Tensor& qkv, const at::Tensor& gather,
                                     const at::Tensor& inverse, int64_t heads, int64_t patch,
                                     bool bf16) {
  using Signature = at::Tensor(const at::Tensor&, const std::optional<at::Tensor>&,
                               const std::optional<at::Tensor>&, int64_t, int64_t, bool);
  static const auto op = find_operator<Signature>("lte::patch_attention_inference");
  const auto given = [](const at::Tensor& t) {
    return t.defined() ? std::optional(t) : std::nullopt;
  };
  return op.call(qkv, given(gather), given(inverse), heads, patch, bf16);
}

}  // namespace lte::ops
