#include "infer/common/untrained_light.h"

#include <algorithm>

#include "lte/base/check.h"

namespace lte::infer {

std::string untrained_light_note(const scene::Scene& scene, const nn::ModelMetadata& model) {
  const auto suns = std::count_if(
      scene.lights.begin(), scene.lights.end(), [](const scene::PunctualLight& light) {
        return light.kind == scene::LightKind::Directional && max_component(light.intensity) > 0;
      });
  if (suns == 0 || model.suns) return "";
  return concat(scene.name, ": ", suns, suns == 1 ? " directional light" : " directional lights",
                ", but the model was trained without any: its indirect light is less certain here; "
                "lte_render --mode reference traces it");
}

}  // namespace lte::infer
