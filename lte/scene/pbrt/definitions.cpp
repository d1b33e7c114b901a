// The directives that define things: options, textures, materials, lights, shapes.
#include <bit>
#include <utility>

#include "lte/scene/pbrt/builder.h"

namespace lte::scene::pbrt {
namespace {

/// Types of the two kinds of textures, v3's name of one included.
bool is_spectrum_texture(const std::string& type) {
  return type == "spectrum" || type == "color" || type == "rgb";
}

}  // namespace

void Builder::camera(Call& call) {
  need_options(call);
  const Transform& world_to_camera = current(call.at);
  named_transforms_["camera"] = {inverse(state_.transform[0], call.at),
                                 inverse(state_.transform[1], call.at)};
  camera_ = CameraCall{call.strings[0], params(call, ""), world_to_camera};
}

void Builder::film(Call& call) {
  need_options(call);
  film_ = params(call, "");
}

void Builder::world_begin(Call& call) {
  need_options(call);
  in_world_ = true;
  state_.transform = {};
  state_.active = {true, true};
  named_transforms_["world"] = state_.transform;
}

void Builder::texture(Call& call) {
  const std::string &name = call.strings[0], &kind = call.strings[1], &type = call.strings[2];
  const bool is_float = kind == "float";
  if (!is_float && !is_spectrum_texture(kind))
    fail(call.at, "Texture ", quote(name), " of type ", quote(kind),
         ", expected spectrum or float");
  if (!texture_names_.insert({is_float, name}).second)
    fail(call.at, "the texture ", quote(name), " is defined twice");
  TextureDef def{name, is_float, type, params(call, "texture")};
  world_.textures.push_back(std::move(def));
}

void Builder::material(Call& call) {
  MaterialDef def{call.strings[0], call.strings[0], call.at, params(call, "material")};
  state_.material = static_cast<int>(world_.materials.size());
  world_.materials.push_back(std::move(def));
}

int Builder::material_number(const std::string& name, const Location& at) {
  const auto [place, is_new] =
      world_.named_materials.insert({name, static_cast<int>(world_.materials.size())});
  if (is_new) world_.materials.push_back({name, "", at, {}});
  return place->second;
}

void Builder::make_named_material(Call& call) {
  const std::string name = call.strings[0];
  MaterialDef& def = world_.materials[static_cast<size_t>(material_number(name, call.at))];
  if (def.params) fail(call.at, "the material ", quote(name), " is made twice, first at ", def.at);
  Params own = params(call, "material");
  if (!own.has("type")) fail(call.at, "MakeNamedMaterial ", quote(name), " needs \"string type\"");
  def.type = own.text("type", "");
  def.at = call.at;
  def.params = std::move(own);
}

void Builder::named_material(Call& call) {
  state_.material = material_number(call.strings[0], call.at);
}

void Builder::area_light_source(Call& call) {
  if (call.strings[0] != "diffuse" && call.strings[0] != "area") {
    world_.ignored.add("AreaLightSource " + quote(call.strings[0]), call.at);
    state_.area_light = kNone;
    return;
  }
  state_.area_light = static_cast<int>(world_.area_lights.size());
  world_.area_lights.push_back(params(call, "light"));
}

void Builder::light_source(Call& call) {
  need_world(call);
  const std::string type = call.strings[0];
  if (type == "infinite") {
    add_infinite_light(params(call, "light"), current(call.at), *files_, &world_.ignored,
                       &world_.infinite);
    return;
  }
  std::optional<PunctualLight> light =
      build_light(type, params(call, "light"), current(call.at), *files_, &world_.ignored);
  if (light) world_.lights.push_back(std::move(*light));
}

void Builder::shape(Call& call) {
  need_world(call);
  const std::string type = call.strings[0];
  const Params own = params(call, "shape");
  if (object_ && state_.area_light != kNone)
    world_.ignored.add("area light in an object: pbrt has none there, ignored", call.at);
  const int area_light = object_ ? kNone : state_.area_light;

  // Scenes of thousands of spheres have a few different ones.
  std::string key;
  if (area_light == kNone && (type == "sphere" || type == "cylinder" || type == "disk")) {
    key = concat(type, state_.reverse_orientation, " ", state_.material);
    for (const char* name : {"radius", "zmin", "zmax", "phimax", "height", "innerradius"}) {
      if (own.has(name))
        key += concat(" ", name, " ", std::bit_cast<uint64_t>(own.number(name, 0)));
    }
  }
  const auto known = quadrics_.find(key);
  int index = kNone;
  if (known != quadrics_.end()) {
    index = known->second;
    ignore_left_out(own, &world_.ignored);
  } else {
    BuiltShape built = build_shape(type, own, state_.reverse_orientation, *files_, &world_.ignored);
    if (built.mesh.triangles.empty()) return;
    triangles_ += static_cast<int64_t>(built.mesh.triangles.size());
    if (triangles_ > limits_.triangles)
      throw OverLimit(concat(call.at, ": more than ", limits_.triangles, " triangles"),
                      "triangles");
    if (built.mesh.name.empty()) built.mesh.name = concat(type, " ", call.at);
    index = static_cast<int>(world_.shapes.size());
    world_.shapes.push_back(
        {std::move(built.mesh), built.parts, state_.material, area_light, call.at});
    if (!key.empty()) quadrics_[key] = index;
  }
  (object_ ? object_parts_ : world_.placements).push_back({index, "", current(call.at), call.at});
}

}  // namespace lte::scene::pbrt
