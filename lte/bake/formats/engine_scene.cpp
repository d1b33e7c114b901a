#include "lte/bake/formats/engine_scene.h"

#include <algorithm>
#include <cctype>

#include "lte/base/check.h"
#include "lte/image/exr.h"
#include "lte/image/image.h"
#include "lte/scene/export.h"

namespace lte::bake {

std::string node_name(const Lightmap& map, size_t instance) {
  std::string name = map.placements[instance].name;
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  // Digits alone would not do: importers look past them for their endings.
  return concat(name, "_n", instance);
}

scene::Scene engine_scene(const Lightmap& map) {
  scene::Scene scene = map.scene;
  if (map.provenance.include == "full") scene.lights.clear();
  for (scene::Material& material : scene.materials) {
    material.metallic = 0;
    material.metallic_roughness_texture = {};
  }
  // The exporter calls a node after the luminaire that it is.
  scene.light_groups.clear();
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    scene.light_groups.push_back(node_name(map, i));
    scene.instances[i].light_group = static_cast<int>(i);
  }
  for (scene::PunctualLight& light : scene.lights) light.light_group = scene::kNone;
  return scene;
}

std::vector<Rgb> radiosity(const Lightmap& map) {
  const std::vector<float> total = map.total();
  std::vector<Rgb> out(map.pixels());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = Rgb{total[3 * i], total[3 * i + 1], total[3 * i + 2]} * (1 / kPi);
  return out;
}

void write_radiosity_exr(const Lightmap& map, FileSet* files) {
  image::Image picture(map.width, map.height, 3);
  const std::vector<Rgb> values = radiosity(map);
  for (size_t i = 0; i < values.size(); ++i) picture.set_rgb(i, values[i]);
  files->write("lightmap.exr", [&](const std::filesystem::path& path) {
    image::write_exr(path, {{"", &picture}}, {{"lte.units", kRadiosityUnits}},
                     image::ExrChannels::Half);
  });
}

std::string filled(std::string text,
                   const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [key, value] : values) {
    const std::string mark = "{{" + key + "}}";
    for (size_t at = text.find(mark); at != std::string::npos;
         at = text.find(mark, at + value.size())) {
      text.replace(at, mark.size(), value);
    }
  }
  return text;
}

void write_scene_and_record(const Lightmap& map, const std::string& image, const std::string& units,
                            FileSet* files) {
  files->write("scene.glb", [&](const std::filesystem::path& path) {
    scene::write_glb(path, engine_scene(map));
  });
  files->write("lightmap.json", [&](const std::filesystem::path& path) {
    if (units.empty()) return write_lightmap_json(path, map, image);
    write_lightmap_json(path, map, image, units);
  });
}

}  // namespace lte::bake
