#include "infer/light/untrained_light.h"

#include <set>

#include "infer/light/unreached_light.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Light groups of the suns that shine.
std::set<int> sun_groups(const scene::Scene& scene) {
  std::set<int> groups;
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.kind == scene::LightKind::Directional && max_component(light.intensity) > 0)
      groups.insert(light.light_group);
  }
  return groups;
}

bool has_sky(const scene::Scene& scene) {
  return scene.environment && max_component(scene::fluence(*scene.environment)) > 0;
}

/// The scene's name, and what shines on it from outside.
std::string lights_text(const scene::Scene& scene) {
  const size_t suns = sun_groups(scene).size();
  std::string text;
  if (suns > 0) text = concat(suns, suns == 1 ? " directional light" : " directional lights");
  if (has_sky(scene)) text += text.empty() ? "an environment" : " and an environment";
  return concat(scene.name, ": ", text);
}

}  // namespace

bool has_untrained_light(const scene::Scene& scene, const nn::ModelMetadata& model) {
  return !model.suns && (has_sky(scene) || !sun_groups(scene).empty());
}

std::string untrained_light_note(const scene::Scene& scene, const nn::ModelMetadata& model) {
  if (!has_untrained_light(scene, model)) return "";
  return concat(lights_text(scene),
                ", but the model was trained without such light: its indirect light is wrong here; "
                "lte_render --untrained-light trace finds it by paths");
}

std::string traced_light_note(const scene::Scene& scene, int spp) {
  return concat(lights_text(scene),
                ", but the model was trained without such light: indirect light is path-traced, ",
                spp, " paths a pixel (--untrained-light network asks the network)");
}

void leave_out_untrained_suns(const scene::Scene& scene, const nn::ModelMetadata& model,
                              scene::SurfaceSamples* samples) {
  const std::set<int> suns = sun_groups(scene);
  if (model.suns || suns.empty() || suns.size() >= scene.light_groups.size()) return;
  keep_points([&](int group) { return !suns.contains(group); }, samples);
}

}  // namespace lte::infer
