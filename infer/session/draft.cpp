#include "infer/session/draft.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

using scene::kNone;

Rgb hue_of(const Rgb& emission) {
  const float peak = max_component(emission);
  return peak > 0 ? emission / peak : Rgb{1, 1, 1};
}

bool near(const Rgb& a, const Rgb& b) {
  constexpr float kRounding = 1e-6f;
  return std::fabs(a.x - b.x) <= kRounding && std::fabs(a.y - b.y) <= kRounding &&
         std::fabs(a.z - b.z) <= kRounding;
}

/// Gives each group meshes and materials that no other shines by.
class Separation {
 public:
  explicit Separation(Draft* draft) : draft_(*draft) {}

  void run() {
    for (scene::Instance& instance : draft_.instances) {
      const MeshUse use = draft_.meshes[static_cast<size_t>(instance.mesh)];
      const scene::Material& material = draft_.materials[static_cast<size_t>(use.material)];
      if (instance.light_group == kNone || !material.emissive()) continue;
      instance.mesh = own_mesh(instance.mesh, use, instance.light_group);
    }
  }

 private:
  int own_material(int material, int group) {
    const auto [owner, is_first] = owner_of_material_.emplace(material, group);
    if (owner->second == group) return material;
    const auto [copy, is_new] = material_of_.emplace(std::pair(material, group), 0);
    if (is_new) {
      copy->second = static_cast<int>(draft_.materials.size());
      draft_.materials.push_back(draft_.materials[static_cast<size_t>(material)]);
      draft_.material_labels.push_back(draft_.material_labels[static_cast<size_t>(material)]);
    }
    return copy->second;
  }

  int own_mesh(int mesh, const MeshUse& use, int group) {
    const auto [owner, is_first] = owner_of_mesh_.emplace(mesh, group);
    const int material = own_material(use.material, group);
    if (owner->second == group) {
      draft_.meshes[static_cast<size_t>(mesh)].material = material;
      return mesh;
    }
    const auto [copy, is_new] = mesh_of_.emplace(std::pair(mesh, group), 0);
    if (is_new) {
      copy->second = static_cast<int>(draft_.meshes.size());
      draft_.meshes.push_back({use.base, material});
    }
    return copy->second;
  }

  Draft& draft_;
  std::map<int, int> owner_of_mesh_, owner_of_material_;
  std::map<std::pair<int, int>, int> mesh_of_, material_of_;
};

/// What the parts of each luminaire emit.
std::vector<std::vector<Rgb>> emissions(const Draft& draft) {
  std::vector<std::vector<Rgb>> out(draft.settings.size());
  const std::vector<int> group = group_of_material(draft);
  for (size_t m = 0; m < group.size(); ++m) {
    if (group[m] != kNone)
      out[static_cast<size_t>(group[m])].push_back(draft.materials[m].emission);
  }
  for (const scene::PunctualLight& light : draft.lights)
    out[static_cast<size_t>(light.light_group)].push_back(light.intensity);
  if (draft.environment)
    out[static_cast<size_t>(draft.environment->light_group)].push_back(draft.environment->radiance);
  return out;
}

auto key(const scene::PunctualLight& l) {
  return std::tuple(l.kind, l.position, l.direction, l.intensity, l.range, l.inner_cone,
                    l.outer_cone, l.light_group);
}

bool same_light(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  return key(a) == key(b);
}

bool same_instance(const scene::Instance& a, const scene::Instance& b) {
  return a.mesh == b.mesh && a.to_world.m == b.to_world.m && a.light_group == b.light_group;
}

bool same_color(const scene::Material& a, const scene::Material& b) {
  return a.base_color == b.base_color && a.emission == b.emission;
}

bool same_environment(const std::optional<scene::Environment>& a,
                      const std::optional<scene::Environment>& b) {
  if (!a || !b) return !a && !b;
  return a->radiance == b->radiance && a->map == b->map && a->axes == b->axes &&
         a->light_group == b->light_group;
}

template <typename T, typename Same>
bool all_same(const std::vector<T>& a, const std::vector<T>& b, const Same& same) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

}  // namespace

Rgb LightSetting::scale() const {
  const auto factor = static_cast<float>(gain);
  if (!color) return {factor, factor, factor};
  const Rgb from = hue.value_or(Rgb{1, 1, 1});
  return Rgb{color->x / from.x, color->y / from.y, color->z / from.z} * factor;
}

int64_t Draft::bytes() const {
  size_t bytes = sizeof(Draft) + instances.size() * sizeof(scene::Instance) +
                 meshes.size() * sizeof(MeshUse) + materials.size() * sizeof(scene::Material) +
                 lights.size() * sizeof(scene::PunctualLight) +
                 settings.size() * sizeof(LightSetting) +
                 (instance_labels.size() + material_labels.size()) * sizeof(Label);
  return static_cast<int64_t>(bytes);
}

std::string unused_name(const std::string& name, const std::vector<std::string>& taken) {
  const auto is_taken = [&](const std::string& text) {
    return std::find(taken.begin(), taken.end(), text) != taken.end();
  };
  std::string out = name;
  for (int number = 2; is_taken(out); ++number) out = concat(name, "#", number);
  return out;
}

std::vector<int> group_of_material(const Draft& draft) {
  std::vector<int> group(draft.materials.size(), kNone);
  for (const scene::Instance& instance : draft.instances) {
    const auto material =
        static_cast<size_t>(draft.meshes[static_cast<size_t>(instance.mesh)].material);
    if (draft.materials[material].emissive()) group[material] = instance.light_group;
  }
  return group;
}

void describe_lights(Draft* draft) {
  const std::vector<std::vector<Rgb>> parts = emissions(*draft);
  for (size_t g = 0; g < parts.size(); ++g) {
    LightSetting& setting = draft->settings[g];
    setting.brightness = 0;
    setting.hue = parts[g].empty() ? Rgb{1, 1, 1} : hue_of(parts[g].front());
    for (const Rgb& emission : parts[g]) {
      setting.brightness = std::max(setting.brightness, max_component(emission));
      if (setting.hue && !near(*setting.hue, hue_of(emission))) setting.hue.reset();
    }
  }
}

Draft make_draft(const scene::Scene& scene, NextIds* ids) {
  Draft draft;
  draft.base_meshes = scene.meshes.size();
  draft.base_materials = scene.materials.size();
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    draft.meshes.push_back({static_cast<int>(m), scene.meshes[m].material});
  draft.instances = scene.instances;
  draft.materials = scene.materials;
  draft.lights = scene.lights;
  draft.environment = scene.environment;
  std::map<std::string, int> used;
  const auto unique = [&](const std::string& kind, const std::string& name) {
    const int number = ++used[kind + name];
    return number == 1 ? name : concat(name, "#", number);
  };
  for (const scene::Material& material : scene.materials)
    draft.material_labels.push_back({ids->material++, unique("m", material.name)});
  for (const std::string& name : scene.light_groups) {
    LightSetting setting;
    setting.label = {ids->light++, unique("l", name)};
    draft.settings.push_back(std::move(setting));
  }
  for (const scene::Instance& instance : scene.instances) {
    const std::string& name = instance.light_group != kNone
                                  ? scene.light_groups[static_cast<size_t>(instance.light_group)]
                                  : scene.meshes[static_cast<size_t>(instance.mesh)].name;
    draft.instance_labels.push_back({ids->instance++, unique("i", name)});
  }
  Separation(&draft).run();
  describe_lights(&draft);
  return draft;
}

scene::Scene make_scene(const scene::Scene& base, const Draft& draft, bool lit) {
  scene::Scene out;
  out.name = base.name;
  out.unit = base.unit;
  out.ignored = base.ignored;
  out.textures = base.textures;
  out.cameras = base.cameras;
  out.meshes.reserve(draft.meshes.size());
  for (const MeshUse& use : draft.meshes) {
    out.meshes.push_back(base.meshes[static_cast<size_t>(use.base)]);
    out.meshes.back().material = use.material;
  }
  out.instances = draft.instances;
  out.materials = draft.materials;
  out.lights = draft.lights;
  out.environment = draft.environment;
  for (const LightSetting& setting : draft.settings) out.light_groups.push_back(setting.label.name);
  if (!lit) return out;
  const auto scale = [&](int group) { return draft.settings[static_cast<size_t>(group)].scale(); };
  const std::vector<int> group = group_of_material(draft);
  for (size_t m = 0; m < group.size(); ++m) {
    if (group[m] != kNone) out.materials[m].emission *= scale(group[m]);
  }
  for (scene::PunctualLight& light : out.lights) light.intensity *= scale(light.light_group);
  if (out.environment) out.environment->radiance *= scale(out.environment->light_group);
  return out;
}

bool same_geometry(const Draft& a, const Draft& b) {
  return a.meshes == b.meshes && all_same(a.instances, b.instances, same_instance);
}

bool same_points(const Draft& a, const Draft& b) {
  const auto same_id = [](const LightSetting& s, const LightSetting& t) {
    return s.label.id == t.label.id;
  };
  return same_geometry(a, b) && all_same(a.materials, b.materials, same_color) &&
         all_same(a.lights, b.lights, same_light) &&
         same_environment(a.environment, b.environment) &&
         all_same(a.settings, b.settings, same_id);
}

bool same_scene(const Draft& a, const Draft& b) {
  const auto same_gain = [](const LightSetting& s, const LightSetting& t) {
    return s.scale() == t.scale();
  };
  return same_points(a, b) && all_same(a.settings, b.settings, same_gain);
}

Bounds placed_bounds(const scene::Mesh& mesh, const Affine& to_world) {
  Bounds bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) bounds.extend(to_world.point(mesh.positions[corner]));
  }
  return bounds;
}

std::optional<std::vector<Bounds>> changed_places(const scene::Scene& base, const Draft& before,
                                                  const Draft& now) {
  const auto same_role = [](const scene::Instance& a, const scene::Instance& b) {
    return a.mesh == b.mesh && a.light_group == b.light_group;
  };
  const auto same_reflection = [](const scene::Material& a, const scene::Material& b) {
    return (max_component(a.base_color) > 0) == (max_component(b.base_color) > 0) &&
           a.emission == b.emission;
  };
  if (before.meshes != now.meshes || !all_same(before.instances, now.instances, same_role) ||
      !all_same(before.materials, now.materials, same_reflection) ||
      !all_same(before.lights, now.lights, same_light) ||
      !same_environment(before.environment, now.environment) ||
      before.settings.size() != now.settings.size())
    return std::nullopt;
  std::vector<Bounds> out;
  for (size_t i = 0; i < now.instances.size(); ++i) {
    const scene::Instance &a = before.instances[i], &b = now.instances[i];
    if (same_instance(a, b)) continue;
    if (a.light_group != kNone) return std::nullopt;
    const int mesh = now.meshes[static_cast<size_t>(a.mesh)].base;
    for (const Affine& place : {a.to_world, b.to_world})
      out.push_back(placed_bounds(base.meshes[static_cast<size_t>(mesh)], place));
  }
  return out;
}

size_t index_of(const std::vector<Label>& labels, int id, const char* what) {
  const auto found = std::find_if(labels.begin(), labels.end(),
                                  [&](const Label& label) { return label.id == id; });
  LTE_CHECK(found != labels.end(), "there is no ", what, " of the number ", id);
  return static_cast<size_t>(found - labels.begin());
}

size_t group_of(const Draft& draft, int id) {
  const auto found =
      std::find_if(draft.settings.begin(), draft.settings.end(),
                   [&](const LightSetting& setting) { return setting.label.id == id; });
  LTE_CHECK(found != draft.settings.end(), "there is no luminaire of the number ", id);
  return static_cast<size_t>(found - draft.settings.begin());
}

}  // namespace lte::infer
