#include "infer/view/session_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "lte/base/check.h"
#include "lte/scene/luminaire_power.h"

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
    const MaterialInfo* const material = find_entry(materials, part->material);
    if (material == nullptr || material->name.empty()) continue;
    made_of += (made_of.empty() ? "" : ", ") + material->name;
  }
  return made_of.empty() ? concat("object ", number) : made_of;
}

ObjectDescription object_of(const std::vector<const InstanceInfo*>& parts,
                            const std::string& name) {
  ObjectDescription object;
  object.id = parts.front()->id;
  object.name = name;
  for (const InstanceInfo* part : parts) {
    object.instances.push_back(part->id);
    object.to_world.push_back(part->to_world);
    object.bounds.extend(part->bounds.low);
    object.bounds.extend(part->bounds.high);
    object.shines = object.shines || part->light != scene::kNone;
  }
  return object;
}

std::vector<Shown> outputs_of(const SessionState& state) {
  if (!state.has_light()) return {Shown::Albedo, Shown::Normal};
  return {Shown::Full,      Shown::Indirect,   Shown::Direct, Shown::Irradiance,
          Shown::Reference, Shown::Difference, Shown::Albedo, Shown::Normal};
}

/// The entry of this number. @throws lte::Error if there is none
template <typename Entries>
const auto& entry_of(const Entries& entries, int id, const char* what) {
  const auto* const found = find_entry(entries, id);
  LTE_CHECK(found != nullptr, "there is no ", what, ' ', id, " in the scene");
  return *found;
}

Affine shifted(const Affine& to_world, const Vec3& move) {
  Affine out = to_world;
  for (int axis = 0; axis < 3; ++axis) out.m[static_cast<size_t>(axis)][3] += move[axis];
  return out;
}

/// Watts by which a lamp that is added lights a scene: the median of the lamps that shine in it.
/// Where none does, those that a panel of --add-light auto has.
float usual_power(const SessionState& state) {
  const float median = scene::median_power(scene::luminaire_powers(state.scene()));
  if (median > 0) return median;
  constexpr float kWattsPerFloor = 10;  // W/m²
  const Vec3 size = state.bvh().bounds().extent();
  return kWattsPerFloor * std::max(size.x * size.z, 1e-3f);
}

void add_edits(const LightSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  const LightDescription& light = entry_of(scene.lights, setting.light, "light");
  out->push_back(SetLight{light.id, double{setting.gain}, setting.color});
  if (!setting.position && !setting.direction) return;
  LTE_CHECK(!setting.position || light.sort == "point" || light.sort == "spot", "light ",
            setting.light,
            ": only point and spot lights have a position; move the object that shines");
  LTE_CHECK(!setting.direction || light.sort == "spot" || light.sort == "sun", "light ",
            setting.light, ": only spot lights and suns have a direction");
  out->push_back(MoveLight{light.id, setting.position, setting.direction});
}

void add_edits(const MaterialSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  const int id = entry_of(scene.materials, setting.material, "material").id;
  out->push_back(SetMaterial{id, setting.albedo});
}

void add_edits(const ObjectSetting& setting, const SceneDescription& scene,
               std::vector<infer::Edit>* out) {
  const ObjectDescription& object = entry_of(scene.objects, setting.object, "object");
  const bool home = setting.placement == Placement();
  const Affine change = placed(setting.placement, object.foot());
  for (size_t i = 0; i < object.instances.size(); ++i) {
    const Affine& loaded = object.to_world[i];
    out->push_back(MoveInstance{object.instances[i], home ? loaded : change * loaded});
  }
}

}  // namespace

std::vector<ObjectDescription> list_objects(const SessionState& first) {
  const std::vector<InstanceInfo> instances = first.instances();
  const std::vector<MaterialInfo> materials = first.materials();
  std::vector<ObjectDescription> objects;
  for (size_t begin = 0, end = 0; begin < instances.size(); begin = end) {
    std::vector<const InstanceInfo*> parts;
    const Affine& placed = instances[begin].to_world;
    do {
      parts.push_back(&instances[end++]);
    } while (end < instances.size() && !is_identity(placed) &&
             instances[end].to_world.m == placed.m);
    objects.push_back(object_of(parts, object_name(parts, materials, objects.size())));
  }
  return objects;
}

ObjectDescription describe_object(const SessionState& state, const std::vector<int>& instances,
                                  const std::string& name) {
  const std::vector<InstanceInfo> all = state.instances();
  std::vector<const InstanceInfo*> parts;
  for (const int id : instances) {
    parts.push_back(find_entry(all, id));
    LTE_CHECK(parts.back() != nullptr, "there is no instance ", id);
  }
  return object_of(parts, name);
}

SceneDescription describe_scene(const SessionState& state,
                                const std::vector<ObjectDescription>& objects) {
  SceneDescription out;
  const scene::Scene& scene = state.scene();
  out.name = scene.name;
  out.cameras = scene.cameras;
  out.bounds = scene.bounds();
  out.outputs = outputs_of(state);
  for (const LuminaireInfo& light : state.luminaires())
    out.lights.push_back({light.id, light.name, sort_name(light.kind)});
  for (const MaterialInfo& material : state.materials())
    out.materials.push_back({material.id, material.name, material.textured, material.emissive});
  const std::vector<InstanceInfo> instances = state.instances();
  for (const ObjectDescription& known : objects) {
    ObjectDescription object = known;
    object.instances.clear();
    object.to_world.clear();
    for (size_t i = 0; i < known.instances.size(); ++i) {
      if (find_entry(instances, known.instances[i]) == nullptr) continue;
      object.instances.push_back(known.instances[i]);
      object.to_world.push_back(known.to_world[i]);
    }
    if (!object.instances.empty()) out.objects.push_back(std::move(object));
  }
  return out;
}

std::vector<PageEdit> settings_of(const SessionState& state, const SceneDescription& scene) {
  std::vector<PageEdit> out;
  for (const LuminaireInfo& light : state.luminaires()) {
    if (find_entry(scene.lights, light.id) == nullptr) continue;
    LightSetting setting{light.id, static_cast<float>(light.gain), light.color};
    const bool spot = light.kind == LuminaireKind::Spot;
    if (spot || light.kind == LuminaireKind::Point) setting.position = light.position;
    if (spot || light.kind == LuminaireKind::Directional) setting.direction = light.direction;
    out.push_back(setting);
  }
  for (const MaterialInfo& material : state.materials()) {
    if (find_entry(scene.materials, material.id) != nullptr)
      out.push_back(MaterialSetting{material.id, material.base_color});
  }
  const std::vector<InstanceInfo> instances = state.instances();
  for (const ObjectDescription& object : scene.objects) {
    const InstanceInfo* now = find_entry(instances, object.instances.front());
    if (now == nullptr) continue;
    out.push_back(ObjectSetting{
        object.id, placement_of(object.to_world.front(), now->to_world, object.foot())});
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

std::vector<infer::Edit> session_edits(const Request& request, const SessionState& state,
                                       const SceneDescription& scene) {
  std::vector<infer::Edit> out;
  if (const auto* copy = std::get_if<CopyObject>(&request)) {
    const std::vector<InstanceInfo> instances = state.instances();
    for (const int id : entry_of(scene.objects, copy->object, "object").instances) {
      const InstanceInfo& like = entry_of(instances, id, "instance");
      out.push_back(AddInstance{id, shifted(like.to_world, copy->move)});
    }
  } else if (const auto* gone = std::get_if<RemoveObject>(&request)) {
    for (const int id : entry_of(scene.objects, gone->object, "object").instances)
      out.push_back(RemoveInstance{id});
  } else if (const auto* lamp = std::get_if<AddLamp>(&request)) {
    scene::PunctualLight light;
    light.name = "lamp";
    light.kind = lamp->kind;
    light.position = lamp->position;
    light.direction = lamp->direction;
    const float intensity = usual_power(state) / (4 * kPi);
    light.intensity = lamp->intensity.value_or(Rgb{intensity, intensity, intensity});
    out.push_back(AddLight{light});
  } else if (const auto* dark = std::get_if<RemoveLamp>(&request)) {
    out.push_back(RemoveLight{entry_of(scene.lights, dark->light, "light").id});
  }
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
  if (find_entry(scene.materials, met->material) != nullptr) out.material = met->material;
  if (find_entry(scene.lights, met->light) != nullptr) out.light = met->light;
  for (const ObjectDescription& object : scene.objects) {
    const std::vector<int>& parts = object.instances;
    if (std::find(parts.begin(), parts.end(), met->instance) != parts.end()) out.object = object.id;
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
  out.accuracy = report.accuracy;
  return out;
}

}  // namespace lte::infer::view
