#include "lte/ops/lobe_radiance.h"

#include <optional>

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "lobe_radiance_inference(Tensor own, Tensor directions, Tensor? light, Tensor? seen, "
      "Tensor mix_weight, Tensor mix_bias, Tensor color_weight, Tensor color_bias) -> Tensor");
}

namespace lte::ops {

at::Tensor lobe_radiance_inference(const at::Tensor& own, const at::Tensor& directions,
                                   const at::Tensor& light, const at::Tensor& seen,
                                   const LobeWeights& weights) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const std::optional<at::Tensor>&,
                 const std::optional<at::Tensor>&, const at::Tensor&, const at::Tensor&,
                 const at::Tensor&, const at::Tensor&);
  static const auto op = find_operator<Signature>("lte::lobe_radiance_inference");
  const auto given = [](const at::Tensor& t) {
    return t.defined() ? std::optional(t) : std::nullopt;
  };
  return op.call(own, directions, given(light), given(seen), weights.mix.weight, weights.mix.bias,
                 weights.color.weight, weights.color.bias);
}

}  // namespace lte::ops
