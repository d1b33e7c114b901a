#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/unique_name.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/scene/export.h"
#include "lte/scene/glb_writer.h"

namespace lte::bake {
namespace {

constexpr const char* kReadme =
    R"(Light of {{source}} at the vertices of scene.glb, without a picture.

Every viewer shows it: materials are unlit (KHR_materials_unlit), and COLOR_0 times the base color
is the light that leaves the surface. COLOR_0 is the mesh's own color times E / pi, linear, over
{{intensity}} W/sr/m2, which all but a thousandth of the texels are below; what exceeds it is 1.
What shines has its emission there. To see it at another exposure, multiply by a factor.

_IRRADIANCE is E itself in W/m2, linear Rec.709: a surface of albedo a sends out a E / pi.
Triangles are cut where light bends; edges that triangles shared are cut alike, so nothing gapes.
In three.js: new MeshBasicMaterial({vertexColors: true}) is what GLTFLoader makes of it.
vertex_light.json has counts, the error that is left, and how the light came about.
{{groups}})";

constexpr const char* kGroups = R"(
COLOR_0 is the sum of these, one a light group and without the limit of 1:
{{list}}
To dim lamps without a bake, set COLOR_0 to the sum of gain times attribute. In three.js, which
writes their names in small letters, for each mesh:
  const at = mesh.geometry.attributes, gain = {{{first}}: 0.5};
  at.color.array.fill(0);
  for (const name of Object.keys(at).filter((name) => name.startsWith('_light')))
    at[name].array.forEach((x, i) => at.color.array[i] += (gain[name] ?? 1) * x);
  at.color.needsUpdate = true;
Blender has them as attributes of the mesh, Bevy by GltfPlugin's add_custom_vertex_attribute;
Godot 4 reads COLOR_0 alone.
)";

/// Names of attributes as glTF and shaders have them: capitals, digits and single underscores.
/// Loaders may write them in small letters, so no two differ by that alone.
std::vector<std::string> attribute_names(const std::vector<VertexLayer>& layers) {
  if (layers.size() == 1) return {"COLOR_0"};
  std::vector<std::string> out;
  std::set<std::string> taken;
  for (const VertexLayer& layer : layers) {
    std::string name = "_LIGHT_";
    for (const char c : layer.name) {
      const auto byte = static_cast<unsigned char>(c);
      if (std::isalnum(byte) != 0) {
        name += static_cast<char>(std::toupper(byte));
      } else if (name.back() != '_') {
        name += '_';
      }
    }
    if (name.back() == '_') name.pop_back();
    out.push_back(unique_name(name, &taken));
  }
  return out;
}

/// What is shown of a mesh by a layer, over `intensity`.
/// @param emission  of the material, where the layer is that of its group
std::vector<Rgb> colors_of(const scene::Mesh& mesh, const scene::Material& material,
                           const std::vector<Rgb>& irradiance, const Rgb& emission,
                           float intensity) {
  std::vector<Rgb> out;
  for (size_t v = 0; v < irradiance.size(); ++v) {
    Rgb color = material.emissive() ? emission : irradiance[v] * (1 / kPi);
    if (!material.emissive() && !mesh.colors.empty()) color *= mesh.colors[v];
    out.push_back(color / intensity);
  }
  return out;
}

scene::Material unlit(const scene::Material& material) {
  scene::Material out;
  out.name = material.name;
  out.double_sided = material.double_sided;
  if (material.emissive()) {
    out.base_color_texture = material.emission_texture;
  } else {
    out.base_color = material.base_color;
    out.base_color_texture = material.base_color_texture;
  }
  return out;
}

/// Adds COLOR_0, and where there are several layers the color of each, to a mesh.
/// @param names  attribute_names()
void add_colors(const Lightmap& map, const VertexLight& light, size_t mesh, float intensity,
                const std::vector<std::string>& names, scene::GlbWriter* writer) {
  const scene::Mesh& shape = light.meshes[mesh];
  const scene::Material& material = map.scene.materials[static_cast<size_t>(shape.material)];
  const int group = map.scene.instances[mesh].light_group;
  nlohmann::json& attributes = writer->json()["meshes"][mesh]["primitives"][0]["attributes"];
  std::vector<Rgb> sum(shape.positions.size());
  for (size_t l = 0; l < names.size(); ++l) {
    const bool own = names.size() == 1 || group == static_cast<int>(l);
    const std::vector<Rgb> colors = colors_of(shape, material, light.layers[l].irradiance[mesh],
                                              own ? material.emission : Rgb{}, intensity);
    for (size_t v = 0; v < sum.size(); ++v) sum[v] += colors[v];
    if (names.size() > 1) attributes[names[l]] = writer->add_vectors(colors);
  }
  for (Rgb& color : sum) color = min(color, Rgb{1, 1, 1});
  attributes["COLOR_0"] = writer->add_vectors(sum);
  attributes["_IRRADIANCE"] = writer->add_vectors(light.total(mesh));
}

void write_scene(const std::filesystem::path& path, const Lightmap& map, const VertexLight& light,
                 float intensity, const std::vector<std::string>& names) {
  scene::Scene scene = engine_scene(map);
  scene.lights.clear();
  scene.meshes = light.meshes;
  for (scene::Mesh& mesh : scene.meshes) mesh.colors.clear();  // COLOR_0 has them
  for (scene::Material& material : scene.materials) material = unlit(material);
  scene::write_glb(path, scene, [&](scene::GlbWriter& writer) {
    nlohmann::json& json = writer.json();
    for (nlohmann::json& material : json["materials"])
      material["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
    json["extensionsUsed"].push_back("KHR_materials_unlit");
    json["asset"]["extras"] = {{"light_intensity", intensity}};
    for (size_t i = 0; i < light.meshes.size(); ++i)
      add_colors(map, light, i, intensity, names, &writer);
  });
}

/// What README.txt says of several layers; empty for one.
std::string help_of_groups(const std::vector<VertexLayer>& layers,
                           const std::vector<std::string>& names) {
  if (layers.size() == 1) return "";
  std::string list;
  for (size_t l = 0; l < layers.size(); ++l)
    list += concat(l > 0 ? "\n  " : "  ", names[l], "  ", layers[l].name);
  return filled(kGroups, {{"list", list}, {"first", lower_case(names[0])}});
}

}  // namespace

void write_vertex_colors(const Lightmap& map, const FormatOptions& options, FileSet* files) {
  const VertexLight light = vertex_light(map, options.vertex);
  const std::vector<std::string> names = attribute_names(light.layers);
  std::vector<float> radiance = map.total();
  for (float& value : radiance) value /= kPi;
  const float intensity = bright(std::move(radiance));
  log_info("vertices: ", light.triangles_before, " triangles cut into ", light.triangles,
           ", light off by ", 100 * light.off_p95, " % or less on 95 % of the surface",
           light.limited ? "; max_triangles kept it from more" : "");
  files->write("scene.glb", [&](const std::filesystem::path& path) {
    write_scene(path, map, light, intensity, names);
  });
  int64_t vertices = 0;
  for (const scene::Mesh& mesh : light.meshes)
    vertices += static_cast<int64_t>(mesh.positions.size());
  nlohmann::json json = to_json(map.provenance);
  json.update(nlohmann::json{{"schema_version", 1},
                             {"scene", "scene.glb"},
                             {"units",
                              "COLOR_0: own color E / pi over intensity, W sr^-1 m^-2, 1 at most; "
                              "_LIGHT_*: the same of a group, without a limit; _IRRADIANCE: E, "
                              "W/m^2; linear Rec.709"},
                             {"intensity", intensity},
                             {"vertices", vertices},
                             {"triangles", light.triangles},
                             {"triangles_before", light.triangles_before},
                             {"limited", light.limited},
                             {"bend", options.vertex.bend},
                             {"off_p95", light.off_p95}});
  for (size_t l = 0; l < names.size(); ++l) {
    json["groups"].push_back({{"name", light.layers[l].name},
                              {"attribute", names[l]},
                              {"off_p95", light.layers[l].off_p95}});
  }
  files->write("vertex_light.json",
               json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  files->write("README.txt", filled(kReadme, {{"source", map.provenance.source},
                                              {"intensity", formatted("%.6g", intensity)},
                                              {"groups", help_of_groups(light.layers, names)}}));
}

}  // namespace lte::bake
