#include "infer/light/untrained_light.h"

#include <algorithm>
#include <set>

#include "infer/light/unreached_light.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

bool contains(std::span<const int> groups, int group) {
  return std::ranges::count(groups, group) > 0;
}

/// Light groups of the suns that shine and are not left out.
std::set<int> sun_groups(const scene::Scene& scene, std::span<const int> left_out) {
  std::set<int> groups;
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.kind == scene::LightKind::Directional && max_component(light.intensity) > 0 &&
        !contains(left_out, light.light_group))
      groups.insert(light.light_group);
  }
  return groups;
}

bool has_sky(const scene::Scene& scene, std::span<const int> left_out) {
  return scene.environment && max_component(scene::fluence(*scene.environment)) > 0 &&
         !contains(left_out, scene.environment->light_group);
}

/// The scene's name, and what shines on it from outside.
std::string lights_text(const scene::Scene& scene, std::span<const int> left_out) {
  const size_t suns = sun_groups(scene, left_out).size();
  std::string text;
  if (suns > 0) text = concat(suns, suns == 1 ? " directional light" : " directional lights");
  if (has_sky(scene, left_out)) text += text.empty() ? "an environment" : " and an environment";
  return concat(scene.name, ": ", text);
}

}  // namespace

bool has_untrained_light(const scene::Scene& scene, const nn::ModelMetadata& model,
                         std::span<const int> left_out) {
  return !model.suns && (has_sky(scene, left_out) || !sun_groups(scene, left_out).empty());
}

std::string untrained_light_note(const scene::Scene& scene, const nn::ModelMetadata& model,
                                 std::span<const int> left_out) {
  if (!has_untrained_light(scene, model, left_out)) return "";
  return concat(lights_text(scene, left_out),
                ", but the model was trained without such light: its indirect light is wrong "
                "here");
}

std::string traced_light_note(const scene::Scene& scene, std::span<const int> left_out) {
  return concat(lights_text(scene, left_out),
                ", but the model was trained without such light: indirect light is path-traced at "
                "the places that rays gather it from");
}

void leave_out_untrained_suns(const scene::Scene& scene, const nn::ModelMetadata& model,
                              scene::SurfaceSamples* samples, std::span<const int> left_out) {
  const std::set<int> suns = sun_groups(scene, left_out);
  const size_t told = scene.light_groups.size() - left_out.size();
  if (model.suns || suns.empty() || suns.size() >= told) return;
  keep_points([&](int group) { return !suns.contains(group); }, samples);
}

}  // namespace lte::infer
