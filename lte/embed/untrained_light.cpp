#include "lte/embed/untrained_light.h"

#include <algorithm>
#include <set>

#include "lte/base/check.h"
#include "lte/embed/culled_lights.h"

namespace lte::embed {
namespace {

bool contains(std::span<const int> groups, int group) {
  return std::ranges::count(groups, group) > 0;
}

/// Light groups of the suns that shine and are not culled.
std::set<int> sun_groups(const scene::Scene& scene, std::span<const int> culled) {
  std::set<int> groups;
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.kind == scene::LightKind::Directional && max_component(light.intensity) > 0 &&
        !contains(culled, light.light_group))
      groups.insert(light.light_group);
  }
  return groups;
}

bool has_sky(const scene::Scene& scene, std::span<const int> culled) {
  return scene.environment && max_component(scene::fluence(*scene.environment)) > 0 &&
         !contains(culled, scene.environment->light_group);
}

/// The scene's name, and what shines on it from outside.
std::string lights_text(const scene::Scene& scene, std::span<const int> culled) {
  const size_t suns = sun_groups(scene, culled).size();
  std::string text;
  if (suns > 0) text = concat(suns, suns == 1 ? " directional light" : " directional lights");
  if (has_sky(scene, culled)) text += text.empty() ? "an environment" : " and an environment";
  return concat(scene.name, ": ", text);
}

}  // namespace

bool has_untrained_light(const scene::Scene& scene, const runtime::ModelMetadata& model,
                         std::span<const int> culled) {
  return !model.suns && (has_sky(scene, culled) || !sun_groups(scene, culled).empty());
}

std::string untrained_light_note(const scene::Scene& scene, const runtime::ModelMetadata& model,
                                 std::span<const int> culled) {
  if (!has_untrained_light(scene, model, culled)) return "";
  return concat(lights_text(scene, culled),
                ", but the model was trained without such light: its indirect light is wrong "
                "here");
}

std::string traced_light_note(const scene::Scene& scene, std::span<const int> culled) {
  return concat(lights_text(scene, culled),
                ", but the model was trained without such light: indirect light is path-traced at "
                "the places that rays gather it from");
}

void drop_untrained_suns(const scene::Scene& scene, const runtime::ModelMetadata& model,
                         scene::SurfaceSamples* samples, std::span<const int> culled) {
  const std::set<int> suns = sun_groups(scene, culled);
  const size_t read = scene.light_groups.size() - culled.size();
  if (model.suns || suns.empty() || suns.size() >= read) return;
  keep_points([&](int group) { return !suns.contains(group); }, samples);
}

}  // namespace lte::embed
