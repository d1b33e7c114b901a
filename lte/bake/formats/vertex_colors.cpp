#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"
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
)";

/// What is shown of a mesh, over `intensity`.
std::vector<Rgb> colors_of(const scene::Mesh& mesh, const scene::Material& material,
                           const std::vector<Rgb>& irradiance, float intensity) {
  std::vector<Rgb> out;
  for (size_t v = 0; v < irradiance.size(); ++v) {
    Rgb color = material.emissive() ? material.emission : irradiance[v] * (1 / kPi);
    if (!material.emissive() && !mesh.colors.empty()) color *= mesh.colors[v];
    out.push_back(min(color / intensity, Rgb{1, 1, 1}));
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

void write_scene(const std::filesystem::path& path, const VertexLight& light, float intensity) {
  scene::Scene scene = light.scene;
  scene.lights.clear();
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    scene::Mesh& mesh = scene.meshes[i];
    mesh.colors = colors_of(mesh, scene.materials[static_cast<size_t>(mesh.material)],
                            light.irradiance[i], intensity);
  }
  for (scene::Material& material : scene.materials) material = unlit(material);
  scene::write_glb(path, scene, [&](scene::GlbWriter& writer) {
    nlohmann::json& json = writer.json();
    for (nlohmann::json& material : json["materials"])
      material["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
    json["extensionsUsed"].push_back("KHR_materials_unlit");
    json["asset"]["extras"] = {{"light_intensity", intensity}};
    for (size_t i = 0; i < light.irradiance.size(); ++i) {
      json["meshes"][i]["primitives"][0]["attributes"]["_IRRADIANCE"] =
          writer.add_vectors(light.irradiance[i]);
    }
  });
}

}  // namespace

void write_vertex_colors(const Lightmap& map, const FormatOptions& options, FileSet* files) {
  Lightmap shown = map;
  shown.scene = engine_scene(map);
  const VertexLight light = vertex_light(shown, options.vertex);
  std::vector<float> radiance = map.total();
  for (float& value : radiance) value /= kPi;
  const float intensity = bright(std::move(radiance));
  log_info("vertices: ", light.triangles_before, " triangles cut into ", light.triangles,
           ", light off by ", 100 * light.off_p95, " % or less on 95 % of the surface",
           light.limited ? "; max_triangles kept it from more" : "");
  files->write("scene.glb",
               [&](const std::filesystem::path& path) { write_scene(path, light, intensity); });
  int64_t vertices = 0;
  for (const std::vector<Rgb>& values : light.irradiance)
    vertices += static_cast<int64_t>(values.size());
  nlohmann::json json = to_json(map.provenance);
  json.update(nlohmann::json{{"schema_version", 1},
                             {"scene", "scene.glb"},
                             {"units",
                              "COLOR_0: own color E / pi over intensity, W sr^-1 m^-2; "
                              "_IRRADIANCE: E, W/m^2; linear Rec.709"},
                             {"intensity", intensity},
                             {"vertices", vertices},
                             {"triangles", light.triangles},
                             {"triangles_before", light.triangles_before},
                             {"limited", light.limited},
                             {"bend", options.vertex.bend},
                             {"off_p95", light.off_p95}});
  files->write("vertex_light.json",
               json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  files->write("README.txt", filled(kReadme, {{"source", map.provenance.source},
                                              {"intensity", formatted("%.6g", intensity)}}));
}

}  // namespace lte::bake
