// What lobe_radiance_inference() accepts, and the sizes that its arguments agree on.
#pragma once

#include <optional>

#include "lte/ops/arguments.h"
#include "lte/ops/lobe_radiance.h"

namespace lte::ops {

struct LobeSizes {
  int64_t points, directions, lobes;
  int64_t features;  ///< that the mixture reads of what is seen
  int64_t factors;

  int64_t rows() const { return points * directions; }
};

inline LobeSizes check_lobe_radiance_args(const at::Tensor& own, const at::Tensor& directions,
                                          const at::Tensor& light, const at::Tensor& seen,
                                          const LobeWeights& w) {
  const char* op = "lobe_radiance_inference";
  TORCH_CHECK(directions.dim() == 3 && w.color.weight.dim() == 2 && w.mix.weight.dim() == 2, op,
              ": directions must be [Q, N, 3] and weights matrices, got ", directions.sizes(), ", ",
              w.mix.weight.sizes(), " and ", w.color.weight.sizes());
  const int64_t Q = directions.size(0), N = directions.size(1), K = w.color.inputs(),
                F = seen.defined() ? kSeenFeatures : 0;
  const LobeSizes sizes{Q, N, K, F, seen.defined() ? 6 : 3};
  TORCH_CHECK(K >= 1, op, ": there are no lobes");
  check_shape(own, {Q, 5 * K}, at::kFloat, op, "own");
  check_shape(directions, {Q, N, 3}, at::kFloat, op, "directions");
  if (light.defined()) check_shape(light, {Q, 3}, at::kFloat, op, "light");
  if (seen.defined()) check_shape(seen, {Q, N, kSeenColumns}, at::kFloat, op, "seen");
  const auto mix_type = w.mix.weight.scalar_type();
  check_shape(w.mix.weight, {K, K + F}, mix_type == at::kBFloat16 ? mix_type : at::kFloat, op,
              "mix");
  check_shape(w.color.weight, {sizes.factors, K}, at::kFloat, op, "color");
  check_shape(w.mix.bias, {K}, at::kFloat, op, "mix's bias");
  check_shape(w.color.bias, {sizes.factors}, at::kFloat, op, "color's bias");
  for (const at::Tensor& t :
       {directions, light, seen, w.mix.weight, w.mix.bias, w.color.weight, w.color.bias}) {
    if (t.defined()) check_device(t, "the others", own, "points", op);
  }
  return sizes;
}

/// The optional arguments of the schema as the tensors that may be undefined here.
inline at::Tensor contiguous_or_undefined(const std::optional<at::Tensor>& t) {
  return t.has_value() ? t->contiguous() : at::Tensor();
}

}  // namespace lte::ops
