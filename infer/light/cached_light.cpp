#include "infer/light/cached_light.h"

#include <ATen/ATen.h>
#include <c10/core/GradMode.h>

#include "lte/nn/model.h"

namespace lte::infer {

std::vector<Rgb> cached_light(const runtime::SceneEmbedding& embedding,
                              const QueryPoints& queries) {
  const at::NoGradGuard no_grad;
  const nn::Embedding parts = embedding.parts();
  if (!parts.cache.defined() || queries.size() == 0) return {};
  const nn::QuerySet asked = runtime::borrow(queries);
  const auto device = parts.position.device();
  const at::Tensor position = (asked.position.to(device) - parts.origin).div(parts.scale);
  const at::Tensor light = (parts.cache.read(position, asked.normal.to(device)).irradiance *
                            parts.emission_scale.to(position.options()))
                               .cpu()
                               .contiguous();
  std::vector<Rgb> out;
  const auto* value = light.const_data_ptr<float>();
  for (int64_t i = 0; i < light.size(0); ++i, value += 3)
    out.push_back({value[0], value[1], value[2]});
  return out;
}

}  // namespace lte::infer
