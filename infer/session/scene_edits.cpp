#include "infer/session/scene_edits.h"

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
  explicit Separation(SceneEdits* edits) : edits_(*edits) {}

  void run() {
    for (scene::Instance& instance : edits_.instances) {
      const MeshUse use = edits_.meshes[static_cast<size_t>(instance.mesh)];
      const scene::Material& material = edits_.materials[static_cast<size_t>(use.material)];
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
      copy->second = static_cast<int>(edits_.materials.size());
      edits_.materials.push_back(edits_.materials[static_cast<size_t>(material)]);
      edits_.material_labels.push_back(edits_.material_labels[static_cast<size_t>(material)]);
    }
    return copy->second;
  }

  int own_mesh(int mesh, const MeshUse& use, int group) {
    const auto [owner, is_first] = owner_of_mesh_.emplace(mesh, group);
    const int material = own_material(use.material, group);
    if (owner->second == group) {
      edits_.meshes[static_cast<size_t>(mesh)].material = material;
      return mesh;
    }
    const auto [copy, is_new] = mesh_of_.emplace(std::pair(mesh, group), 0);
    if (is_new) {
      copy->second = static_cast<int>(edits_.meshes.size());
      edits_.meshes.push_back({use.base, material});
    }
    return copy->second;
  }

  SceneEdits& edits_;
  std::map<int, int> owner_of_mesh_, owner_of_material_;
  std::map<std::pair<int, int>, int> mesh_of_, material_of_;
};

/// What the parts of each luminaire emit.
std::vector<std::vector<Rgb>> emissions(const SceneEdits& edits) {
  std::vector<std::vector<Rgb>> out(edits.settings.size());
  const std::vector<int> group = group_of_material(edits);
  for (size_t m = 0; m < group.size(); ++m) {
    if (group[m] != kNone)
      out[static_cast<size_t>(group[m])].push_back(edits.materials[m].emission);
  }
  for (const scene::PunctualLight& light : edits.lights)
    out[static_cast<size_t>(light.light_group)].push_back(light.intensity);
  if (edits.environment)
    out[static_cast<size_t>(edits.environment->light_group)].push_back(edits.environment->radiance);
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
  const Rgb from = tint.value_or(Rgb{1, 1, 1});
  return Rgb{color->x / from.x, color->y / from.y, color->z / from.z} * factor;
}

std::string unused_name(const std::string& name, const std::vector<std::string>& taken) {
  const auto is_taken = [&](const std::string& text) {
    return std::find(taken.begin(), taken.end(), text) != taken.end();
  };
  std::string out = name;
  for (int number = 2; is_taken(out); ++number) out = concat(name, "#", number);
  return out;
}

std::vector<int> group_of_material(const SceneEdits& edits) {
  std::vector<int> group(edits.materials.size(), kNone);
  for (const scene::Instance& instance : edits.instances) {
    const auto material =
        static_cast<size_t>(edits.meshes[static_cast<size_t>(instance.mesh)].material);
    if (edits.materials[material].emissive()) group[material] = instance.light_group;
  }
  return group;
}

void describe_lights(SceneEdits* edits) {
  const std::vector<std::vector<Rgb>> parts = emissions(*edits);
  for (size_t g = 0; g < parts.size(); ++g) {
    LightSetting& setting = edits->settings[g];
    setting.brightness = 0;
    setting.tint = parts[g].empty() ? Rgb{1, 1, 1} : hue_of(parts[g].front());
    for (const Rgb& emission : parts[g]) {
      setting.brightness = std::max(setting.brightness, max_component(emission));
      if (setting.tint && !near(*setting.tint, hue_of(emission))) setting.tint.reset();
    }
  }
}

SceneEdits make_edits(const scene::Scene& scene, NextIds* ids) {
  SceneEdits edits;
  edits.base_meshes = scene.meshes.size();
  edits.base_materials = scene.materials.size();
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    edits.meshes.push_back({static_cast<int>(m), scene.meshes[m].material});
  edits.instances = scene.instances;
  edits.materials = scene.materials;
  edits.lights = scene.lights;
  edits.environment = scene.environment;
  std::map<std::string, int> used;
  const auto unique = [&](const std::string& kind, const std::string& name) {
    const int number = ++used[kind + name];
    return number == 1 ? name : concat(name, "#", number);
  };
  for (const scene::Material& material : scene.materials)
    edits.material_labels.push_back({ids->material++, unique("m", material.name)});
  for (const std::string& name : scene.light_groups) {
    LightSetting setting;
    setting.label = {ids->light++, unique("l", name)};
    edits.settings.push_back(std::move(setting));
  }
  for (const scene::Instance& instance : scene.instances) {
    const std::string& name = instance.light_group != kNone
                                  ? scene.light_groups[static_cast<size_t>(instance.light_group)]
                                  : scene.meshes[static_cast<size_t>(instance.mesh)].name;
    edits.instance_labels.push_back({ids->instance++, unique("i", name)});
  }
  Separation(&edits).run();
  describe_lights(&edits);
  return edits;
}

scene::Scene make_scene(const scene::Scene& base, const SceneEdits& edits, bool lit) {
  scene::Scene out;
  out.name = base.name;
  out.unit = base.unit;
  out.ignored = base.ignored;
  out.textures = base.textures;
  out.cameras = base.cameras;
  out.meshes.reserve(edits.meshes.size());
  for (const MeshUse& use : edits.meshes) {
    out.meshes.push_back(base.meshes[static_cast<size_t>(use.base)]);
    out.meshes.back().material = use.material;
  }
  out.instances = edits.instances;
  out.materials = edits.materials;
  out.lights = edits.lights;
  out.environment = edits.environment;
  for (const LightSetting& setting : edits.settings) out.light_groups.push_back(setting.label.name);
  if (!lit) return out;
  const auto scale = [&](int group) { return edits.settings[static_cast<size_t>(group)].scale(); };
  const std::vector<int> group = group_of_material(edits);
  for (size_t m = 0; m < group.size(); ++m) {
    if (group[m] != kNone) out.materials[m].emission *= scale(group[m]);
  }
  for (scene::PunctualLight& light : out.lights) light.intensity *= scale(light.light_group);
  if (out.environment) out.environment->radiance *= scale(out.environment->light_group);
  return out;
}

bool same_geometry(const SceneEdits& a, const SceneEdits& b) {
  return a.meshes == b.meshes && all_same(a.instances, b.instances, same_instance);
}

bool same_points(const SceneEdits& a, const SceneEdits& b) {
  const auto same_id = [](const LightSetting& s, const LightSetting& t) {
    return s.label.id == t.label.id;
  };
  return same_geometry(a, b) && all_same(a.materials, b.materials, same_color) &&
         all_same(a.lights, b.lights, same_light) &&
         same_environment(a.environment, b.environment) &&
         all_same(a.settings, b.settings, same_id);
}

bool same_scene(const SceneEdits& a, const SceneEdits& b) {
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

std::optional<std::vector<Bounds>> changed_places(const scene::Scene& base,
                                                  const SceneEdits& before, const SceneEdits& now) {
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

size_t group_of(const SceneEdits& edits, int id) {
  const auto found =
      std::find_if(edits.settings.begin(), edits.settings.end(),
                   [&](const LightSetting& setting) { return setting.label.id == id; });
  LTE_CHECK(found != edits.settings.end(), "there is no luminaire of the number ", id);
  return static_cast<size_t>(found - edits.settings.begin());
}

}  // namespace lte::infer
