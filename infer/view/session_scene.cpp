#include "infer/view/session_scene.h"

#include <algorithm>
#include <optional>
#include <set>

#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

bool is_identity(const Affine& a) { return a.m == Affine().m; }

const char* sort_name(LuminaireKind kind) {
  switch (kind) {
    case LuminaireKind::Point:
      return "point";
    case LuminaireKind::Spot:
      return "spot";
    case LuminaireKind::Directional:
      return "sun";
    case LuminaireKind::Environment:
      return "environment";
    default:
      return "surface";
  }
}

/// The name of a luminaire in it, else what it is made of.
std::string object_name(const std::vector<const InstanceInfo*>& parts,
                        const std::vector<MaterialInfo>& materials, size_t number) {
  std::string made_of;
  std::set<int> seen;
  for (const InstanceInfo* part : parts) {
    if (part->light != scene::kNone && !part->name.empty()) return part->name;
    if (!seen.insert(part->material).second) continue;
    const auto material =
        std::find_if(materials.begin(), materials.end(),
                     [&](const MaterialInfo& info) { return info.id == part->material; });
    if (material == materials.end() || material->name.empty()) continue;
    made_of += (made_of.empty() ? "" : ", ") + material->name;
  }
  return made_of.empty() ? concat("object ", number) : made_of;
}

std::vector<Shown> outputs_of(const SessionState& state) {
  if (!state.has_light()) return {Shown::Albedo, Shown::Normal};
  return {Shown::Full,      Shown::Indirect,   Shown::Direct, Shown::Irradiance,
          Shown::Reference, Shown::Difference, Shown::Albedo, Shown::Normal};
}

void add_objects(const SessionState& state, SceneDescription* out) {
  const std::vector<InstanceInfo> instances = state.instances();
  const std::vector<MaterialInfo> materials = state.materials();
  std::vector<const InstanceInfo*> parts;
  for (size_t i = 0; i < instances.size(); ++i) {
    const InstanceInfo& instance = instances[i];
    const bool joins = i > 0 && !is_identity(instance.to_world) &&
                       instance.to_world.m == instances[i - 1].to_world.m;
    if (!joins) {
      out->objects.emplace_back();
      parts.clear();
    }
    parts.push_back(&instance);
    ObjectDescription& object = out->objects.back();
    object.instances.push_back(instance.id);
    object.to_world.push_back(instance.to_world);
    object.bounds.extend(instance.bounds.low);
    object.bounds.extend(instance.bounds.high);
    object.shines = object.shines || instance.light != scene::kNone;
    object.name = object_name(parts, materials, out->objects.size() - 1);
  }
}

template <typename Entries>
void check_index(int index, const Entries& entries, const char* what) {
  LTE_CHECK(index >= 0 && static_cast<size_t>(index) < entries.size(), what, ' ', index,
            ": the scene has ", entries.size());
}

void add_edits(const LightSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  check_index(setting.light, scene.lights, "light");
  const LightDescription& light = scene.lights[static_cast<size_t>(setting.light)];
  out->push_back(SetLight{light.id, double{setting.gain}, setting.color});
  if (!setting.position) return;
  LTE_CHECK(light.sort == "point" || light.sort == "spot", "light ", setting.light,
            ": only point and spot lights have a position; move the object that shines");
  out->push_back(MoveLight{light.id, *setting.position, std::nullopt});
}

void add_edits(const MaterialSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  check_index(setting.material, scene.materials, "material");
  const auto number = static_cast<size_t>(setting.material);
  out->push_back(SetMaterial{scene.materials[number].id, setting.albedo});
}

void add_edits(const ObjectSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  check_index(setting.object, scene.objects, "object");
  const ObjectDescription& object = scene.objects[static_cast<size_t>(setting.object)];
  const bool home = setting.placement == Placement();
  const Affine change = placed(setting.placement, object.foot());
  for (size_t i = 0; i < object.instances.size(); ++i) {
    const Affine& loaded = object.to_world[i];
    out->push_back(MoveInstance{object.instances[i], home ? loaded : change * loaded});
  }
}

/// The entry whose number in the session is `id`; -1 if there is none.
template <typename Entries>
int index_of(const Entries& entries, int id) {
  for (size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].id == id) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

SceneDescription describe_scene(const SessionState& first) {
  SceneDescription out;
  const scene::Scene& scene = first.scene();
  out.name = scene.name;
  out.cameras = scene.cameras;
  out.bounds = scene.bounds();
  out.outputs = outputs_of(first);
  for (const LuminaireInfo& light : first.luminaires())
    out.lights.push_back({light.id, light.name, sort_name(light.kind)});
  for (const MaterialInfo& material : first.materials())
    out.materials.push_back({material.id, material.name, material.textured, material.emissive});
  add_objects(first, &out);
  return out;
}

std::vector<PageEdit> settings_of(const SessionState& state, const SceneDescription& scene) {
  std::vector<PageEdit> out;
  for (const LuminaireInfo& light : state.luminaires()) {
    const int index = index_of(scene.lights, light.id);
    if (index < 0) continue;
    const bool placed_alone =
        light.kind == LuminaireKind::Point || light.kind == LuminaireKind::Spot;
    out.push_back(LightSetting{index, static_cast<float>(light.gain), light.color,
                               placed_alone ? std::optional(light.position) : std::nullopt});
  }
  for (const MaterialInfo& material : state.materials()) {
    const int index = index_of(scene.materials, material.id);
    if (index >= 0) out.push_back(MaterialSetting{index, material.base_color});
  }
  const std::vector<InstanceInfo> instances = state.instances();
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const ObjectDescription& object = scene.objects[i];
    const auto now = std::find_if(
        instances.begin(), instances.end(),
        [&](const InstanceInfo& instance) { return instance.id == object.instances.front(); });
    if (now == instances.end()) continue;
    out.push_back(ObjectSetting{
        static_cast<int>(i), placement_of(object.to_world.front(), now->to_world, object.foot())});
  }
  return out;
}

std::vector<infer::Edit> session_edits(std::span<const PageEdit> edits,
                                       const SceneDescription& scene) {
  std::vector<infer::Edit> out;
  for (const PageEdit& edit : edits)
    std::visit([&](const auto& setting) { add_edits(setting, scene, &out); }, edit);
  return out;
}

Picked pick(const SessionState& state, const SceneDescription& scene, const scene::Camera& camera,
            float aspect, float x, float y) {
  Picked out;
  out.x = x;
  out.y = y;
  const std::optional<infer::Pick> met = state.pick(camera, x, y, aspect);
  if (!met) return out;
  out.position = met->position;
  out.normal = met->normal;
  out.material = index_of(scene.materials, met->material);
  out.light = index_of(scene.lights, met->light);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const std::vector<int>& parts = scene.objects[i].instances;
    if (std::find(parts.begin(), parts.end(), met->instance) != parts.end())
      out.object = static_cast<int>(i);
  }
  return out;
}

EditCost cost_of(const EditReport& report) {
  EditCost out;
  out.milliseconds = {{"scene", report.scene_ms},
                      {"bvh", report.bvh_ms},
                      {"points", report.points_ms},
                      {"light", report.light_ms},
                      {"encode", report.encode_ms}};
  out.total_ms = report.total_ms;
  out.encodings = report.encodings;
  return out;
}

}  // namespace lte::infer::view
