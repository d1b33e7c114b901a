#include "lte/bake/lightmap.h"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/image/exr.h"

namespace lte::bake {
namespace {

using Json = nlohmann::json;

image::Image picture(const Lightmap& map, const std::vector<float>& values) {
  image::Image out(map.width, map.height, 3);
  LTE_CHECK(out.pixels.size() == values.size(), "a layer has not the size of its light map");
  out.pixels = values;
  return out;
}

/// A layer's name as channels of an EXR may have it: "." parts layers there.
std::string channel_name(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name.empty() ? "light" : name;
}

}  // namespace

Json to_json(const Provenance& p) {
  return {{"source", p.source},
          {"integrator", p.integrator},
          {"model", p.model.empty() ? Json(nullptr) : Json(p.model)},
          {"include", p.include},
          {"version", p.version},
          {"seed", p.seed},
          {"seconds", p.seconds},
          {"expected_error", p.expected_error},
          {"texels_per_metre", p.texels_per_metre},
          {"two_sided_texels", p.two_sided_texels},
          {"metal_instances", p.metal_instances},
          {"kept_texels", p.kept_texels}};
}

std::vector<float> Lightmap::total() const {
  std::vector<float> out(3 * pixels());
  for (const Layer& layer : layers)
    for (size_t i = 0; i < out.size(); ++i) out[i] += layer.irradiance[i];
  return out;
}

void write_lightmap_exr(const std::filesystem::path& path, const Lightmap& map) {
  std::vector<image::Image> pictures{picture(map, map.total())};
  std::vector<std::string> names{""};
  if (map.layers.size() > 1) {
    for (const Layer& layer : map.layers) {
      pictures.push_back(picture(map, layer.irradiance));
      names.push_back(channel_name(layer.name));
    }
  }
  std::vector<image::Layer> layers;
  for (size_t i = 0; i < pictures.size(); ++i) layers.push_back({names[i], &pictures[i]});
  image::write_exr(path, layers, {{"lte.units", "irradiance E, W/m^2"}}, image::ExrChannels::Half);
}

void write_lightmap_json(const std::filesystem::path& path, const Lightmap& map,
                         const std::string& image, const std::string& units) {
  std::array<int64_t, 4> counts{};
  for (const uint8_t texel : map.mask) ++counts[texel];
  Json json = to_json(map.provenance);
  json.update(Json{
      {"schema_version", 1},
      {"image", image},
      {"size", {map.width, map.height}},
      {"units", units},
      {"uv", "TEXCOORD_1, v down, row 0 is the top"},
      {"texels",
       {{"outside", counts[0]}, {"lit", counts[1]}, {"filled", counts[2]}, {"dark", counts[3]}}}});
  for (const Layer& layer : map.layers)
    json["layers"].push_back(
        {{"name", layer.name},
         {"channels", map.layers.size() > 1 ? channel_name(layer.name) + ".R" : "R"}});
  for (const Placement& place : map.placements) {
    json["rectangles"].push_back({{"name", place.name},
                                  {"node", place.node},
                                  {"mesh", place.mesh},
                                  {"source_mesh", place.source_mesh},
                                  {"min", {place.min.x, place.min.y}},
                                  {"max", {place.max.x, place.max.y}}});
  }
  try {
    write_file(path, json.dump(2) + "\n");
  } catch (const Json::exception& error) {  // a name that is not UTF-8
    throw Error(concat(path.string(), ": cannot be written as JSON: ", error.what()));
  }
}

}  // namespace lte::bake
