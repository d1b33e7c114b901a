// Checks of a glTF document, before anything trusts it.
#include "lte/base/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "lte/scene/gltf/element.h"
#include "lte/scene/gltf/extensions.h"
#include "lte/scene/gltf/file.h"

namespace lte::scene::gltf {
namespace {

template <typename T>
bool one_of(const Json& value, std::initializer_list<T> allowed) {
  return std::any_of(allowed.begin(), allowed.end(), [&](const T& item) { return value == item; });
}

void check_buffer_view(const Element& view) {
  view.needs_index("buffer", "buffers");
  view.natural("byteOffset");
  view.needs_natural("byteLength");
  view.natural("byteStride");
  if (view.has("byteStride")) {
    const auto stride = view.json()["byteStride"].get<uint64_t>();
    view.require(stride >= 4 && stride <= 252, ".byteStride must be 4 to 252, got ", stride);
  }
}

void check_accessor(const Element& accessor) {
  accessor.index("bufferView", "bufferViews");
  accessor.natural("byteOffset");
  accessor.needs_natural("count");
  accessor.needs_natural("componentType");
  accessor.require(one_of(accessor.json()["componentType"], {5120, 5121, 5122, 5123, 5125, 5126}),
                   ".componentType is unknown: ", accessor.json()["componentType"].dump());
  accessor.require(
      accessor.has("type") && one_of(accessor.json()["type"],
                                     {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}),
      ".type is missing or unknown");
  if (accessor.has("normalized")) {
    accessor.require(accessor.json()["normalized"].is_boolean(),
                     ".normalized must be true or false");
  }
  if (!accessor.has("sparse")) return;
  const Element sparse = accessor.at("sparse"), indices = sparse.at("indices"),
                values = sparse.at("values");
  sparse.needs_natural("count");
  sparse.require(sparse.json()["count"] <= accessor.json()["count"],
                 ".count exceeds the accessor's");
  for (const Element& part : {indices, values}) {
    part.needs_index("bufferView", "bufferViews");
    part.natural("byteOffset");
  }
  indices.needs_natural("componentType");
  indices.require(one_of(indices.json()["componentType"], {5121, 5123, 5125}),
                  ".componentType must be an unsigned integer type");
}

/// Checks a reference to a texture, with its KHR_texture_transform.
void check_texture_info(const Element& owner, const char* key) {
  if (!owner.has(key)) return;
  const Element info = owner.at(key);
  info.needs_index("index", "textures");
  info.natural("texCoord");
  const Element transform = info.at("extensions").at("KHR_texture_transform");
  transform.numbers("offset", 2);
  transform.numbers("scale", 2);
  transform.number("rotation");
  transform.natural("texCoord");
}

void check_non_negative(const Element& element, const char* key) {
  if (!element.has(key)) return;
  for (const Json& value : element.json()[key]) {
    element.require(value.get<double>() >= 0, ".", key, " must not be negative, got ",
                    Element::shown(value));
  }
}

void check_material(const Element& material) {
  const Element pbr = material.at("pbrMetallicRoughness");
  pbr.numbers("baseColorFactor", 4);
  check_non_negative(pbr, "baseColorFactor");
  check_texture_info(pbr, "baseColorTexture");
  check_texture_info(pbr, "metallicRoughnessTexture");
  const Element glossy = material.at("extensions").at("KHR_materials_pbrSpecularGlossiness");
  glossy.numbers("diffuseFactor", 4);
  check_non_negative(glossy, "diffuseFactor");
  check_texture_info(glossy, "diffuseTexture");
  pbr.number("metallicFactor");
  pbr.number("roughnessFactor");
  check_texture_info(material, "normalTexture");
  check_texture_info(material, "occlusionTexture");
  check_texture_info(material, "emissiveTexture");
  material.numbers("emissiveFactor", 3);
  check_non_negative(material, "emissiveFactor");
  const Element strength = material.at("extensions").at("KHR_materials_emissive_strength");
  strength.number("emissiveStrength");
  if (strength.has("emissiveStrength")) {
    strength.require(strength.json()["emissiveStrength"] >= 0,
                     ".emissiveStrength must not be negative");
  }
  if (material.has("doubleSided")) {
    material.require(material.json()["doubleSided"].is_boolean(),
                     ".doubleSided must be true or false");
  }
  material.text("name");
  material.text("alphaMode");
}

void check_attributes(const Element& attributes) {
  for (const auto& [name, value] : attributes.json().items()) {
    attributes.check_index(value, "." + name, "accessors");
  }
}

void check_primitive(const Element& primitive) {
  primitive.require(primitive.has("attributes"), " has no attributes");
  check_attributes(primitive.at("attributes"));
  primitive.each("targets", check_attributes);
  const Element draco = primitive.at("extensions").at("KHR_draco_mesh_compression");
  if (!draco.json().empty()) {
    draco.needs_index("bufferView", "bufferViews");
    draco.require(draco.has("attributes"), " has no attributes");
    for (const auto& [name, value] : draco.at("attributes").json().items())
      draco.at("attributes").natural(name.c_str());
  }
  primitive.index("indices", "accessors");
  primitive.index("material", "materials");
  primitive.natural("mode");
  if (primitive.has("mode"))
    primitive.require(primitive.json()["mode"] <= 6, ".mode must be 0 to 6");
}

/// Morph weights belong to the targets of a mesh, which all of its primitives have alike.
void check_mesh(const Element& mesh) {
  mesh.each("primitives", check_primitive);
  const Json none = Json::array();
  const Json& primitives = mesh.has("primitives") ? mesh.json()["primitives"] : none;
  const auto targets = [&](size_t k) {
    return primitives[k].contains("targets") ? primitives[k]["targets"].size() : 0;
  };
  for (size_t k = 1; k < primitives.size(); ++k) {
    mesh.require(targets(k) == targets(0), ".primitives[", k, "] has ", targets(k),
                 " morph targets, but primitives[0] has ", targets(0));
  }
  mesh.numbers("weights", primitives.empty() ? 0 : targets(0));
}

void check_node_pose(const Element& node) {
  node.index("skin", "skins");
  if (!node.has("weights")) return;
  node.require(node.has("mesh"), " has weights, but no mesh");
  const Json& mesh = node.root()["meshes"][node.json()["mesh"].get<size_t>()];
  const Json::json_pointer targets("/primitives/0/targets");
  node.numbers("weights", mesh.contains(targets) ? mesh[targets].size() : 0);
}

void check_skin(const Element& skin) {
  skin.require(skin.has("joints"), " has no joints");
  skin.indices("joints", "nodes");
  skin.require(!skin.json()["joints"].empty(), ".joints is empty");
  skin.index("inverseBindMatrices", "accessors");
  skin.index("skeleton", "nodes");
}

void check_node(const Element& node) {
  node.index("mesh", "meshes");
  node.index("camera", "cameras");
  node.indices("children", "nodes");
  node.numbers("matrix", 16);
  node.numbers("translation", 3);
  node.numbers("rotation", 4);
  node.numbers("scale", 3);
  node.text("name");
  check_node_pose(node);
  check_attributes(node.at("extensions").at("EXT_mesh_gpu_instancing").at("attributes"));
  const Element punctual = node.at("extensions").at("KHR_lights_punctual");
  if (!punctual.has("light")) return;
  const Json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
  const Json& value = punctual.json()["light"];
  const Json& root = node.root();
  const size_t count = root.contains(lights) ? root[lights].size() : 0;
  punctual.require(value.is_number_unsigned() && value.get<uint64_t>() < count, ".light is ",
                   Element::shown(value), ", but there are ", count, " lights");
}

void check_light(const Element& light) {
  light.require(light.has("type") && one_of(light.json()["type"], {"point", "spot", "directional"}),
                ".type must be point, spot or directional");
  light.numbers("color", 3);
  check_non_negative(light, "color");
  light.number("intensity");
  light.number("range");
  for (const char* key : {"intensity", "range"}) {
    if (light.has(key)) light.require(light.json()[key] >= 0, ".", key, " must not be negative");
  }
  light.text("name");
  if (light.json()["type"] != "spot") return;
  light.require(light.has("spot"), " has no spot");
  const Element spot = light.at("spot");
  spot.number("innerConeAngle");
  spot.number("outerConeAngle");
  const double inner = spot.json().value("innerConeAngle", 0.0),
               outer = spot.json().value("outerConeAngle", M_PI / 4);
  spot.require(inner >= 0 && inner <= outer && outer <= M_PI / 2 + 1e-6,
               ": cone angles must satisfy 0 <= inner (", inner, ") <= outer (", outer,
               ") <= pi / 2");
}

void check_camera(const Element& camera) {
  camera.require(
      camera.has("type") && one_of(camera.json()["type"], {"perspective", "orthographic"}),
      ".type must be perspective or orthographic");
  camera.text("name");
  if (camera.json()["type"] != "perspective") return;
  const Element lens = camera.at("perspective");
  lens.number("yfov");
  const double yfov = lens.json().value("yfov", 0.0);
  lens.require(yfov > 0 && yfov < M_PI, ".yfov must be between 0 and pi, got ", yfov);
}

void check_asset(const File& file, const Element& root) {
  root.require(root.has("asset"), "not glTF: the JSON has no \"asset\"");
  const Element asset = root.at("asset");
  asset.text("version");
  const std::string version = asset.json().value("version", "");
  LTE_CHECK(version.starts_with("2."), file.name, ": glTF version \"", version,
            "\", only 2 is understood");
  if (!root.has("extensionsRequired")) return;
  root.require(root.json()["extensionsRequired"].is_array(), "extensionsRequired must be an array");
  for (const Json& item : root.json()["extensionsRequired"]) {
    root.require(item.is_string(), "extensionsRequired must hold strings");
    const auto& name = item.get_ref<const std::string&>();
    LTE_CHECK(is_supported_extension(name) || !dropped_with(name).empty(), file.name,
              ": requires extension ", name, ", which lte lacks");
  }
}

}  // namespace

void check_document(const File& file) {
  const Element root(file, file.json, "");
  check_asset(file, root);
  // Lengths of the arrays that indices point to come first: a target that is no array has no
  // length.
  for (const char* key :
       {"accessors", "buffers", "bufferViews", "cameras", "images", "materials", "meshes", "nodes",
        "samplers", "scenes", "textures", "animations", "skins"}) {
    root.each(key, [](const Element& element) { element.text("name"); });
  }
  root.each("buffers", [](const Element& buffer) {
    buffer.needs_natural("byteLength");
    buffer.text("uri");
  });
  root.each("bufferViews", check_buffer_view);
  root.each("accessors", check_accessor);
  root.each("images", [](const Element& image) {
    image.text("uri");
    image.index("bufferView", "bufferViews");
    image.require(image.has("uri") || image.has("bufferView"), " has neither uri nor bufferView");
  });
  root.each("samplers", [](const Element& sampler) {
    for (const char* key : {"wrapS", "wrapT"}) {
      if (sampler.has(key)) {
        sampler.require(one_of(sampler.json()[key], {10497, 33071, 33648}), ".", key,
                        " is unknown: ", Element::shown(sampler.json()[key]));
      }
    }
  });
  root.each("textures", [](const Element& texture) {
    texture.index("source", "images");
    texture.at("extensions").at("EXT_texture_webp").index("source", "images");
    texture.index("sampler", "samplers");
  });
  root.each("materials", check_material);
  root.each("meshes", check_mesh);
  root.each("skins", check_skin);
  root.each("cameras", check_camera);
  root.at("extensions").at("KHR_lights_punctual").each("lights", check_light);
  root.each("nodes", check_node);
  root.each("scenes", [](const Element& scene) { scene.indices("nodes", "nodes"); });
  root.index("scene", "scenes");
}

}  // namespace lte::scene::gltf
