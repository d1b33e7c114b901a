#include "infer/eval/measure/embed_sample.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/data/light_groups.h"
#include "lte/data/sample_rows.h"

namespace lte::infer {
namespace {

/// What the network reads of the light on the sample's scene points.
data::PointIrradiance light_of(const data::SceneSample& sample, const runtime::Network& network) {
  if (network.light_request().depth == 0) return {};
  LTE_CHECK(!sample.scene_direct.empty(), sample.name,
            ": has no scene_direct, which the model reads; bake the data again");
  LTE_CHECK(!sample.scene_direct_back.empty(), sample.name,
            ": has no scene_direct_back, the light on each side of a surface, which the model "
            "reads; bake the data again");
  const std::vector<float> error = data::to_floats(sample.scene_error),
                           error_back = data::to_floats(sample.scene_error_back);
  return data::sum_groups({sample.scene_direct, sample.scene_indirect, sample.scene_direct_back,
                           sample.scene_indirect_back, error, error_back},
                          sample.light_groups);
}

/// Metallic and roughness of each scene point; empty where nothing is metal.
std::vector<float> gloss_of(const data::SceneSample& sample) {
  std::vector<float> gloss;
  for (size_t i = 0; i < sample.scene_metallic.size(); ++i) {
    gloss.push_back(sample.scene_metallic[i]);
    gloss.push_back(sample.scene_roughness[i]);
  }
  return gloss;
}

}  // namespace

void thin_for(const runtime::Network& network, int64_t count, data::SceneSample* sample) {
  data::thin_scene_points(sample, count > 0 ? count : network.metadata().scene_points);
}

runtime::SceneEmbedding embed_sample(const data::SceneSample& sample,
                                     const runtime::Network& network,
                                     const runtime::MemoryLimit& memory) {
  const data::PointIrradiance light = light_of(sample, network);
  const std::vector<float> gloss = gloss_of(sample);
  return runtime::SceneEmbedding(
      network,
      {sample.scene_position, sample.scene_normal, sample.scene_albedo, sample.scene_emission,
       sample.scene_area, light.direct, light.indirect, light.direct_back, light.indirect_back,
       light.error, gloss},
      {.memory = memory});
}

}  // namespace lte::infer
