// What a state answers.
#include <algorithm>
#include <utility>

#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/scene/export.h"
#include "lte/scene/surface.h"

namespace lte::infer {
namespace {

using scene::kNone;

Bounds bounds_of(const scene::Scene& scene, const scene::Instance& instance) {
  return placed_bounds(scene.meshes[static_cast<size_t>(instance.mesh)], instance.to_world);
}

LuminaireKind kind_of(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::Point:
      return LuminaireKind::Point;
    case scene::LightKind::Spot:
      return LuminaireKind::Spot;
    default:
      return LuminaireKind::Directional;
  }
}

Rgb color_of(const LightSetting& setting) {
  return setting.color ? *setting.color : setting.tint.value_or(Rgb{1, 1, 1});
}

/// The number of the one entry of this name.
int find_name(const char* what, const std::string& name, const std::vector<Label>& labels) {
  std::vector<std::string> names;
  for (const Label& label : labels) {
    if (label.name == name) return label.id;
    names.push_back(label.name);
  }
  const std::string near = nearest_name(name, names);
  if (!near.empty())
    throw Error(concat("there is no ", what, " \"", name, "\"; did you mean \"", near, "\"?"));
  constexpr size_t kShown = 12;
  std::string list;
  for (size_t i = 0; i < std::min(names.size(), kShown); ++i)
    list += concat(i == 0 ? "" : ", ", names[i]);
  if (names.size() > kShown) list += concat(" and ", names.size() - kShown, " more");
  throw Error(concat("there is no ", what, " \"", name, "\"; there ",
                     names.empty() ? concat("is no ", what, " at all") : concat("are ", list)));
}

}  // namespace

SessionState::SessionState(std::unique_ptr<const Parts> parts) : parts_(std::move(parts)) {}
SessionState::~SessionState() = default;

uint64_t SessionState::version() const { return parts_->version; }
Accuracy SessionState::accuracy() const { return parts_->accuracy; }
const scene::Scene& SessionState::scene() const { return *parts_->scene; }
const pathtrace::Bvh& SessionState::bvh() const { return *parts_->bvh; }
const pathtrace::Lights& SessionState::lights() const { return *parts_->lights; }
bool SessionState::has_light() const { return !parts_->lights->empty(); }
bool SessionState::has_network() const { return parts_->asks_network; }
std::optional<Method> SessionState::answered_by() const { return parts_->answered_by; }

std::vector<int> SessionState::culled_lights() const {
  if (parts_->culled_lights == nullptr) return {};
  return groups_of(*parts_->edits, parts_->culled_lights->lights);
}

std::vector<LuminaireInfo> SessionState::luminaires() const {
  const SceneEdits& edits = *parts_->edits;
  std::vector<LuminaireInfo> out(edits.settings.size());
  for (size_t g = 0; g < out.size(); ++g) {
    const LightSetting& setting = edits.settings[g];
    out[g].id = setting.label.id;
    out[g].name = setting.label.name;
    out[g].gain = setting.gain;
    out[g].color = color_of(setting);
    out[g].brightness = setting.brightness;
    out[g].touched = setting.touched;
  }
  std::vector<Bounds> bounds(out.size());
  for (size_t i = 0; i < edits.instances.size(); ++i) {
    const scene::Instance& instance = edits.instances[i];
    if (instance.light_group == kNone) continue;
    const auto group = static_cast<size_t>(instance.light_group);
    out[group].instances.push_back(edits.instance_labels[i].id);
    const Bounds own = bounds_of(*parts_->scene, instance);
    if (own.empty()) continue;
    bounds[group].extend(own.low);
    bounds[group].extend(own.high);
    out[group].position = bounds[group].center();
  }
  for (const scene::PunctualLight& light : edits.lights) {
    LuminaireInfo& info = out[static_cast<size_t>(light.light_group)];
    info.kind = kind_of(light.kind);
    if (light.kind != scene::LightKind::Directional) info.position = light.position;
    if (light.kind != scene::LightKind::Point) info.direction = light.direction;
  }
  if (edits.environment)
    out[static_cast<size_t>(edits.environment->light_group)].kind = LuminaireKind::Environment;
  return out;
}

std::vector<InstanceInfo> SessionState::instances() const {
  const SceneEdits& edits = *parts_->edits;
  std::vector<InstanceInfo> out(edits.instances.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const scene::Instance& instance = edits.instances[i];
    const MeshUse& use = edits.meshes[static_cast<size_t>(instance.mesh)];
    out[i].id = edits.instance_labels[i].id;
    out[i].name = edits.instance_labels[i].name;
    out[i].material = edits.material_labels[static_cast<size_t>(use.material)].id;
    if (instance.light_group != kNone)
      out[i].light = edits.settings[static_cast<size_t>(instance.light_group)].label.id;
    out[i].to_world = instance.to_world;
    out[i].bounds = bounds_of(*parts_->scene, instance);
  }
  return out;
}

std::vector<MaterialInfo> SessionState::materials() const {
  const SceneEdits& edits = *parts_->edits;
  std::vector<MaterialInfo> out;
  for (size_t m = 0; m < edits.base_materials; ++m) {
    const scene::Material& material = edits.materials[m];
    out.push_back({edits.material_labels[m].id, edits.material_labels[m].name, material.base_color,
                   material.base_color_texture.texture != kNone, material.emissive()});
  }
  return out;
}

int SessionState::find_luminaire(const std::string& name) const {
  std::vector<Label> labels;
  for (const LightSetting& setting : parts_->edits->settings) labels.push_back(setting.label);
  return find_name("light", name, labels);
}

int SessionState::find_instance(const std::string& name) const {
  return find_name("instance", name, parts_->edits->instance_labels);
}

int SessionState::find_material(const std::string& name) const {
  std::vector<Label> labels = parts_->edits->material_labels;
  labels.resize(parts_->edits->base_materials);
  return find_name("material", name, labels);
}

Frame SessionState::render(const scene::Camera& camera, RenderSettings settings,
                           StageSeconds* seconds) const {
  return parts_->render(camera, std::move(settings), seconds);
}

Frame SessionState::Parts::render(const scene::Camera& camera, RenderSettings settings,
                                  StageSeconds* seconds) const {
  Renderer renderer(bvh, lights, base->denoiser);
  if (settings.method != Method::Path) settings.method = answered_by.value_or(Method::Path);
  if (renderer.needs_cache(settings)) renderer.set_cache(cache->get());
  Frame frame = renderer.render(camera, settings);
  if (seconds != nullptr) *seconds = renderer.seconds();
  return frame;
}

std::vector<Rgb> SessionState::irradiance(const runtime::QueryPoints& queries) const {
  LTE_CHECK(parts_->asks_network,
            "irradiance at points needs a network that knows the scene's "
            "kinds of light");
  return parts_->answer(queries);
}

std::optional<Pick> SessionState::pick(const scene::Camera& camera, float x, float y,
                                       float aspect) const {
  const pathtrace::Hit hit =
      parts_->bvh->intersect({camera.origin, camera.direction(x, y, aspect), 0, INFINITY});
  if (!hit.valid()) return std::nullopt;
  const scene::Surface surface = scene::evaluate_surface(*parts_->scene, hit.instance, hit.triangle,
                                                         hit.u, hit.v, /*footprint=*/0);
  const SceneEdits& edits = *parts_->edits;
  const scene::Instance& instance = edits.instances[static_cast<size_t>(hit.instance)];
  Pick out;
  out.instance = edits.instance_labels[static_cast<size_t>(hit.instance)].id;
  const MeshUse& use = edits.meshes[static_cast<size_t>(instance.mesh)];
  out.material = edits.material_labels[static_cast<size_t>(use.material)].id;
  if (instance.light_group != kNone)
    out.light = edits.settings[static_cast<size_t>(instance.light_group)].label.id;
  out.position = surface.position;
  const bool faces = dot(hit.normal, camera.origin - surface.position) >= 0;
  out.normal = faces ? hit.normal : -hit.normal;
  out.albedo = surface.albedo;
  out.distance = hit.t;
  return out;
}

void SessionState::write_glb(const std::filesystem::path& path) const {
  scene::write_glb(path, *parts_->scene);
}

}  // namespace lte::infer
