#include "lte/scene/export.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/scene/glb_writer.h"

namespace lte::scene {
namespace {

using Json = nlohmann::json;

Json to_json(const Vec2& v) { return {v.x, v.y}; }
/// Writes 0 and 1 without a decimal point.
Json to_json(float v) { return v == 0 || v == 1 ? Json(static_cast<int>(v)) : Json(v); }

/// Column-major 4x4, as glTF has it.
Json to_matrix(const Affine& a) {
  Json out = Json::array();
  for (size_t col = 0; col < 4; ++col) {
    for (size_t row = 0; row < 3; ++row) out.push_back(a.m[row][col]);
    out.push_back(col == 3 ? 1 : 0);
  }
  return out;
}

/// A frame at `origin` whose -Z, along which cameras and lights look, is `forward`.
Affine looking(const Vec3& origin, const Vec3& forward, const Vec3& up) {
  const Vec3 z = normalize(-forward);
  Vec3 x = cross(up, z), y;
  if (!(length(x) > 1e-6f)) make_frame(z, &x, &y);
  x = normalize(x);
  y = cross(z, x);
  Affine out;
  out.m = {{{x.x, y.x, z.x, origin.x}, {x.y, y.y, z.y, origin.y}, {x.z, y.z, z.z, origin.z}}};
  return out;
}

/// A texture as PNG. glTF's colors carry the sRGB curve and its other pictures do not, so a texture
/// that has it otherwise is brought onto or off the curve.
std::vector<unsigned char> to_png(const Texture& texture, bool color) {
  image::Image picture(texture.width(), texture.height(), 3);
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    const float value = static_cast<float>(texture.texels()[i]) / 255.0f;
    picture.pixels[i] = texture.srgb() == color ? value
                        : color                 ? image::linear_to_srgb(value)
                                                : image::srgb_to_linear(value);
  }
  return image::encode_png(picture);
}

int wrap_code(Wrap wrap) {
  if (wrap == Wrap::ClampToEdge) return 33071;
  return wrap == Wrap::MirroredRepeat ? 33648 : 10497;
}

class Exporter {
 public:
  explicit Exporter(const Scene& scene) : scene_(scene) {}

  void write(const std::filesystem::path& path, const std::function<void(GlbWriter&)>& change) {
    json()["asset"] = {{"version", "2.0"}, {"generator", "lte"}};
    json()["extensionsUsed"] = Json::array();
    add_images();
    for (const Material& material : scene_.materials)
      json()["materials"].push_back(to_json_material(material));
    for (const Mesh& mesh : scene_.meshes) add_mesh(mesh);
    for (const Instance& instance : scene_.instances) add_instance(instance);
    for (const PunctualLight& light : scene_.lights) add_light(light);
    for (const Camera& camera : scene_.cameras) add_camera(camera);
    Json roots = Json::array();
    for (size_t i = 0; i < json()["nodes"].size(); ++i) roots.push_back(i);
    json()["scenes"] = {{{"name", scene_.name}, {"nodes", std::move(roots)}}};
    json()["scene"] = 0;
    if (change) change(writer_);
    writer_.write(path);
  }

 private:
  Json& json() { return writer_.json(); }

  void use_extension(const char* name) {
    Json& used = json()["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  }

  void add_image(const Texture& texture, bool color) {
    const std::vector<unsigned char> png = to_png(texture, color);
    json()["images"].push_back(
        {{"bufferView", writer_.add_bytes(png.data(), png.size())}, {"mimeType", "image/png"}});
  }

  /// Adds an image for each texture, in their order, and behind them a second one for each texture
  /// that serves both as colors and otherwise.
  void add_images() {
    std::set<int> colors, others;
    for (const Material& material : scene_.materials) {
      colors.insert({material.base_color_texture.texture, material.emission_texture.texture});
      others.insert({material.metallic_roughness_texture.texture, material.normal_texture.texture});
    }
    others.erase(kNone);
    for (size_t i = 0; i < scene_.textures.size(); ++i) {
      const auto index = static_cast<int>(i);
      const bool color = colors.contains(index) || !others.contains(index);
      if (!color) linear_image_[index] = index;
      add_image(*scene_.textures[i], color);
    }
    for (const int index : others) {
      if (!linear_image_.try_emplace(index, static_cast<int>(json()["images"].size())).second)
        continue;
      add_image(*scene_.textures[static_cast<size_t>(index)], /*color=*/false);
    }
  }

  /// Index of the element of `list` that equals `element`, which is added if there is none.
  size_t intern(const char* list, const Json& element) {
    Json& items = json()[list];
    for (size_t i = 0; i < items.size(); ++i) {
      if (items[i] == element) return i;
    }
    items.push_back(element);
    return items.size() - 1;
  }

  Json to_json_ref(const TextureRef& ref) { return to_json_ref(ref, ref.texture); }

  Json to_json_ref(const TextureRef& ref, int image) {
    const size_t sampler =
        intern("samplers", {{"wrapS", wrap_code(ref.wrap_u)}, {"wrapT", wrap_code(ref.wrap_v)}});
    Json out{{"index", intern("textures", {{"source", image}, {"sampler", sampler}})}};
    if (ref.uv_set != 0) out["texCoord"] = ref.uv_set;
    const bool plain =
        ref.offset.x == 0 && ref.offset.y == 0 && ref.scale.x == 1 && ref.scale.y == 1;
    if (!plain || ref.rotation != 0) {
      use_extension("KHR_texture_transform");
      out["extensions"]["KHR_texture_transform"] = {{"offset", to_json(ref.offset)},
                                                    {"scale", to_json(ref.scale)},
                                                    {"rotation", ref.rotation}};
    }
    return out;
  }

  Json to_json_material(const Material& material) {
    const Rgb& base = material.base_color;
    Json pbr{{"baseColorFactor", {base.x, base.y, base.z, 1}},
             {"metallicFactor", to_json(material.metallic)},
             {"roughnessFactor", to_json(material.roughness)}};
    if (material.base_color_texture.texture != kNone)
      pbr["baseColorTexture"] = to_json_ref(material.base_color_texture);
    if (const TextureRef& ref = material.metallic_roughness_texture; ref.texture != kNone)
      pbr["metallicRoughnessTexture"] = to_json_ref(ref, linear_image_.at(ref.texture));
    Json out{{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
    if (const TextureRef& ref = material.normal_texture; ref.texture != kNone) {
      out["normalTexture"] = to_json_ref(ref, linear_image_.at(ref.texture));
      if (material.normal_scale != 1) out["normalTexture"]["scale"] = material.normal_scale;
    }
    if (material.double_sided) out["doubleSided"] = true;
    if (!material.emissive()) return out;
    // A power of two as strength: factor * strength gives back the very same floats.
    const float peak = max_component(material.emission);
    const float strength = peak > 1 ? std::exp2(std::ceil(std::log2(peak))) : 1.0f;
    out["emissiveFactor"] = vector_json(material.emission / strength);
    if (strength != 1) {
      use_extension("KHR_materials_emissive_strength");
      out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
    }
    if (material.emission_texture.texture != kNone)
      out["emissiveTexture"] = to_json_ref(material.emission_texture);
    return out;
  }

  void add_mesh(const Mesh& mesh) {
    Json attributes{{"POSITION", writer_.add_positions(mesh.positions)}};
    for (size_t set = 0; set < mesh.uvs.size(); ++set) {
      if (!mesh.uvs[set].empty())
        attributes[concat("TEXCOORD_", set)] = writer_.add_vectors(mesh.uvs[set]);
    }
    if (!mesh.colors.empty()) attributes["COLOR_0"] = writer_.add_vectors(mesh.colors);
    if (!mesh.normals.empty()) attributes["NORMAL"] = writer_.add_vectors(mesh.normals);
    if (!mesh.tangents.empty()) attributes["TANGENT"] = writer_.add_vectors(mesh.tangents);
    json()["meshes"].push_back({{"name", mesh.name},
                                {"primitives",
                                 {{{"attributes", std::move(attributes)},
                                   {"indices", writer_.add_indices(mesh.triangles)},
                                   {"material", mesh.material}}}}});
  }

  void add_instance(const Instance& instance) {
    Json node{{"mesh", instance.mesh}, {"matrix", to_matrix(instance.to_world)}};
    if (instance.light_group != kNone)
      node["name"] = scene_.light_groups[static_cast<size_t>(instance.light_group)];
    json()["nodes"].push_back(std::move(node));
  }

  void add_light(const PunctualLight& light) {
    use_extension("KHR_lights_punctual");
    // The intensity is a power of two at or above the peak: products are exact, and colors lie
    // within [0, 1].
    const float peak = max_component(light.intensity);
    const float intensity = peak > 0 ? std::exp2(std::ceil(std::log2(peak))) : 0.0f;
    Json out{{"name", light.name}, {"intensity", intensity}};
    if (peak > 0) out["color"] = vector_json(light.intensity / intensity);
    if (std::isfinite(light.range)) out["range"] = light.range;
    out["type"] = light.kind == LightKind::Point  ? "point"
                  : light.kind == LightKind::Spot ? "spot"
                                                  : "directional";
    if (light.kind == LightKind::Spot) {
      out["spot"] = {{"innerConeAngle", light.inner_cone}, {"outerConeAngle", light.outer_cone}};
    }
    Json& lights = json()["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(out));
    Json node{{"name", light.name},
              {"matrix", to_matrix(looking(light.position, light.direction, {0, 1, 0}))}};
    node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
    json()["nodes"].push_back(std::move(node));
  }

  void add_camera(const Camera& camera) {
    const double yfov = double{camera.vfov} * (M_PI / 180.0);
    json()["cameras"].push_back({{"name", camera.name},
                                 {"type", "perspective"},
                                 {"perspective", {{"yfov", yfov}, {"znear", 0.01}}}});
    Affine frame = looking(camera.origin, camera.target - camera.origin, camera.up);
    if (camera.mirrored) {
      for (std::array<float, 4>& row : frame.m) row[0] = -row[0];
    }
    json()["nodes"].push_back({{"name", camera.name},
                               {"camera", json()["cameras"].size() - 1},
                               {"matrix", to_matrix(frame)}});
  }

  const Scene& scene_;
  GlbWriter writer_;
  std::map<int, int> linear_image_;  ///< of the textures that hold no colors
};

}  // namespace

void write_glb(const std::filesystem::path& path, const Scene& scene) {
  write_glb(path, scene, {});
}

void write_glb(const std::filesystem::path& path, const Scene& scene,
               const std::function<void(GlbWriter&)>& change) {
  try {
    Exporter(scene).write(path, change);
  } catch (const Json::exception& error) {  // a name that is not UTF-8
    throw Error(concat(path.string(), ": cannot be written as JSON: ", error.what()));
  }
}

}  // namespace lte::scene
