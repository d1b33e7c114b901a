#include "lte/bake/lightmap.h"

#include <algorithm>
#include <array>
#include <set>

#include <nlohmann/json.hpp>

#include "lte/bake/unique_name.h"
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

/// Names of layers as channels of an EXR may have them: "." parts layers there.
std::vector<std::string> channel_names(const Lightmap& map) {
  std::vector<std::string> out;
  std::set<std::string> taken;
  for (const Layer& layer : map.layers) {
    std::string name = layer.name.empty() ? "light" : layer.name;
    std::replace(name.begin(), name.end(), '.', '_');
    out.push_back(unique_name(name, &taken));
  }
  return out;
}

}  // namespace

Json to_json(const Provenance& p) {
  return {{"source", p.source},
          {"integrator", p.integrator},
          {"model", p.model.empty() ? Json(nullptr) : Json(p.model)},
          {"include", p.include},
          {"version", p.version},
          {"denoiser", p.denoiser.empty() ? Json(nullptr) : Json(p.denoiser)},
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
  const std::vector<std::string> names = channel_names(map);
  if (names.size() > 1)
    for (const Layer& layer : map.layers) pictures.push_back(picture(map, layer.irradiance));
  std::vector<image::Layer> layers;
  for (size_t i = 0; i < pictures.size(); ++i)
    layers.push_back({i == 0 ? "" : names[i - 1], &pictures[i]});
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
  const std::vector<std::string> names = channel_names(map);
  for (size_t l = 0; l < names.size(); ++l)
    json["layers"].push_back(
        {{"name", map.layers[l].name}, {"channels", names.size() > 1 ? names[l] + ".R" : "R"}});
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
