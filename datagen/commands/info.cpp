#include "datagen/commands/info.h"

#include <cmath>
#include <map>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "lte/base/check.h"
#include "lte/data/dataset.h"
#include "lte/scene/environment_points.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/inspect/inspect.h"
#include "lte/scene/load_camera.h"
#include "lte/scene/luminaire_power.h"
#include "lte/scene/metal.h"
#include "lte/scene/sampler.h"
#include "lte/scene/surface.h"

namespace lte::datagen {
namespace {

Json vec(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json bounds_json(const Vec3& low, const Vec3& high) {
  return {{"low", vec(low)}, {"high", vec(high)}, {"extent_m", vec(high - low)}};
}

Rgb mean(const std::vector<Rgb>& values, double divisor) {
  double sum[3] = {};
  for (const Rgb& v : values)
    for (int c = 0; c < 3; ++c) sum[c] += v[c];
  const auto part = [&](int c) { return static_cast<float>(divisor > 0 ? sum[c] / divisor : 0); };
  return {part(0), part(1), part(2)};
}

/// What enters the sphere around the scene.
Rgb environment_power(const scene::Scene& scene) {
  const float radius = scene::environment_sphere(scene).radius;
  return scene::fluence(*scene.environment) * (kPi * radius * radius);
}

Json environment_info(const scene::Environment& environment) {
  const Rgb mean = scene::fluence(environment) / (4 * kPi);
  if (!environment.map) return {{"kind", "constant"}, {"mean_radiance", vec(mean)}};
  const bool square = environment.map->mapping() == scene::SphereMapping::EqualArea;
  return {{"kind", square ? "equal-area picture" : "equirectangular picture"},
          {"size", {environment.map->width(), environment.map->height()}},
          {"mean_radiance", vec(mean)}};
}

data::DatasetInfo read_info(const std::filesystem::path& directory) {
  try {
    return data::read_dataset_info(directory);
  } catch (const data::UnfinishedDataset& error) {
    throw Error(concat(
        error.what(), " (generate --resume makes the rest, generate --merge lists what is there)"));
  }
}

}  // namespace

std::vector<Rgb> group_powers(const scene::Scene& scene) {
  std::vector<Rgb> powers = scene::luminaire_powers(scene);
  if (scene.environment && scene.environment->light_group != scene::kNone)
    powers[static_cast<size_t>(scene.environment->light_group)] += environment_power(scene);
  return powers;
}

namespace {

Json texture_list(const scene::Scene& scene) {
  std::vector<int> uses(scene.textures.size());
  std::vector<std::string> first(scene.textures.size());  // the file's names are not kept
  for (const scene::Material& material : scene.materials) {
    for (const auto& [ref, what] : {std::pair{&material.base_color_texture, "base color"},
                                    {&material.emission_texture, "emission"},
                                    {&material.metallic_roughness_texture, "metal, roughness"},
                                    {&material.normal_texture, "normals"}}) {
      if (ref->texture == scene::kNone) continue;
      const auto number = static_cast<size_t>(ref->texture);
      if (uses[number]++ == 0) first[number] = concat(what, " of ", material.name);
    }
  }
  Json list = Json::array();
  for (size_t i = 0; i < uses.size(); ++i) {
    const scene::Texture& texture = *scene.textures[i];
    list.push_back({{"name", first[i]},
                    {"width", texture.width()},
                    {"height", texture.height()},
                    {"bytes", texture.size_bytes()},
                    {"uses", uses[i]}});
  }
  return list;
}

Json camera_list(const scene::Scene& scene) {
  Json list = Json::array();
  for (const scene::Camera& camera : scene.cameras)
    list.push_back(Json::parse(scene::camera_json(camera)));
  return list;
}

Json group_list(const scene::Scene& scene) {
  std::vector<const char*> kinds(scene.light_groups.size(), "surface");
  for (const scene::PunctualLight& light : scene.lights) {
    if (light.light_group == scene::kNone) continue;
    kinds[static_cast<size_t>(light.light_group)] = light.kind == scene::LightKind::Point ? "point"
                                                    : light.kind == scene::LightKind::Spot
                                                        ? "spot"
                                                        : "directional";
  }
  if (scene.environment && scene.environment->light_group != scene::kNone)
    kinds[static_cast<size_t>(scene.environment->light_group)] = "environment";
  Json groups = Json::array();
  const std::vector<Rgb> powers = group_powers(scene);
  for (size_t g = 0; g < powers.size(); ++g)
    groups.push_back(
        {{"name", scene.light_groups[g]}, {"kind", kinds[g]}, {"power_w", vec(powers[g])}});
  for (const scene::PunctualLight& sun : scene.lights) {  // of these power is not defined
    if (sun.kind != scene::LightKind::Directional || sun.light_group == scene::kNone) continue;
    Json& group = groups[static_cast<size_t>(sun.light_group)];
    group.erase("power_w");
    group["irradiance_w_m2"] = vec(sun.intensity);
  }
  return groups;
}

Json fingerprint_info(const scene::Scene& scene) {
  const scene::Fingerprint print = fingerprint(scene);
  return {{"geometry", print.geometry}, {"materials", print.materials}, {"lights", print.lights}};
}

Json scene_info_without_geometry(const scene::Scene& scene) {
  size_t texture_bytes = 0;
  for (const auto& texture : scene.textures) texture_bytes += texture->size_bytes();
  int64_t stored = 0;
  for (const scene::Mesh& mesh : scene.meshes)
    stored += static_cast<int64_t>(mesh.triangles.size());
  const Bounds bounds = scene.bounds();
  return {{"kind", "scene"},
          {"name", scene.name},
          {"fingerprint", fingerprint_info(scene)},
          {"triangles", scene.triangle_count()},
          {"stored_triangles", stored},
          {"meshes", scene.meshes.size()},
          {"instances", scene.instances.size()},
          {"materials", scene.materials.size()},
          {"textures", scene.textures.size()},
          {"texture_bytes", texture_bytes},
          {"texture_list", texture_list(scene)},
          {"punctual_lights", scene.lights.size()},
          {"cameras", scene.cameras.size()},
          {"camera_list", camera_list(scene)},
          {"area_m2", scene::surface_area(scene)},
          {"bounds", bounds_json(bounds.low, bounds.high)},
          {"unit", scene.unit},
          {"light_groups", group_list(scene)},
          {"ignored", scene.ignored}};
}

Json geometry_info(const scene::GeometryFaults& report) {
  if (!report.inspected)
    return {{"not_inspected", concat("more than ", scene::kMaxInspected, " triangles")}};
  return {{"degenerate_triangles", report.degenerate_triangles},
          {"duplicate_triangles", report.duplicate_triangles},
          {"opposite_triangles", report.opposite_triangles},
          {"conflicting_triangles", report.conflicting_triangles},
          {"near_duplicate_vertices", report.near_duplicate_vertices},
          {"open_edges", report.open_edges},
          {"open_edge_length_m", report.open_edge_length_m},
          {"branching_edges", report.branching_edges},
          {"flipped_edges", report.flipped_edges},
          {"closed_shells", report.closed_shells},
          {"inward_shells", report.inward_shells}};
}

}  // namespace

Json scene_info(const scene::Scene& scene) {
  Json info = scene_info_without_geometry(scene);
  const scene::MetalShare metal = scene::metal_share(scene);
  if (metal.metal > 0) {
    info["metal"] = {{"share_of_area", metal.metal},
                     {"by_gltf_default", metal.by_default},
                     {"note", scene::metal_text(metal, "surface")}};
  }
  if (scene.environment) info["environment"] = environment_info(*scene.environment);
  info["geometry"] = geometry_info(scene::inspect(scene));
  return info;
}

Json sample_info(const data::SceneSample& sample) {
  double area = 0;
  for (const float a : sample.scene_area) area += a;
  const auto N = static_cast<double>(sample.query_points());
  double variance = 0;
  for (const float v : sample.variance) variance += v;
  Json views = Json::array();
  for (const data::View& view : sample.views) views.push_back(concat(view.width, "x", view.height));
  return {{"kind", "sample"},
          {"name", sample.name},
          {"scene_geometry", sample.geometry},
          {"scene_points", sample.scene_points()},
          {"query_points", sample.query_points()},
          {"pruned_scene_points", sample.pruned_scene_points},
          {"pruned_query_points", sample.pruned_query_points},
          {"light_groups", sample.light_groups},
          {"views", views},
          {"rays", sample.rays},
          {"target_error", sample.target_error},
          {"max_depth", sample.max_depth},
          {"seed", sample.seed},
          {"area_m2", area},
          {"mean_direct", vec(mean(sample.direct, N))},
          {"mean_indirect", vec(mean(sample.indirect, N))},
          {"mean_standard_error", std::sqrt(variance / N)},
          {"path_traced_64", !sample.path_traced_64.empty()},
          {"metal", !sample.scene_metallic.empty()},
          {"incident",
           {{"points", sample.incident.points()},
            {"bins", sample.incident.bins},
            {"samples", sample.incident.samples},
            {"bytes", sample.incident.size_bytes()}}},
          {"bounds", bounds_json(sample.bounds_low, sample.bounds_high)}};
}

Json dataset_info(const std::filesystem::path& directory, bool deep) {
  const data::DatasetInfo info = read_info(directory);
  std::map<data::Split, int64_t> splits{
      {data::Split::Train, 0}, {data::Split::Val, 0}, {data::Split::Test, 0}};
  int64_t scene_points = 0, query_points = 0;
  uintmax_t bytes = 0;
  for (const data::DatasetEntry& entry : info.scenes) {
    ++splits[entry.split];
    scene_points += entry.scene_points;
    query_points += entry.query_points;
    const auto path = data::scene_path(directory, entry.name);
    bytes += std::filesystem::file_size(path);
    if (!deep) continue;
    const data::SceneSample sample = data::read_scene_sample(path);
    LTE_CHECK(
        sample.scene_points() == entry.scene_points && sample.query_points() == entry.query_points,
        path.string(), ": ", sample.scene_points(), " scene and ", sample.query_points(),
        " query points, but dataset.json says ", entry.scene_points, " and ", entry.query_points);
  }
  Json split_counts;
  for (const auto& [split, count] : splits) split_counts[data::split_name(split)] = count;
  return {{"kind", "dataset"},
          {"scenes", info.scenes.size()},
          {"planned", info.planned},
          {"pruned", info.pruned},
          {"suns", info.suns},
          {"splits", split_counts},
          {"scene_points", scene_points},
          {"query_points", query_points},
          {"bytes", bytes},
          {"scale_m", info.scale},
          {"seed", info.seed},
          {"tool", info.tool_version},
          {"version", info.version}};
}

namespace {

/// Whether YAML would read a plain `text` as something else than a text.
bool reads_as_other(const std::string& text) {
  const YAML::Node node(text);
  double number = 0;
  bool truth = false;
  return YAML::convert<double>::decode(node, number) || YAML::convert<bool>::decode(node, truth);
}

/// Entries of the outermost map and of the maps and lists in it stand on lines of their own.
void emit(const Json& value, int depth, YAML::Emitter* out) {
  const bool numbers = value.is_array() && !value.empty() && value[0].is_number();
  const auto style = depth < 2 && !value.empty() && !numbers ? YAML::Block : YAML::Flow;
  if (value.is_object()) {
    *out << style << YAML::BeginMap;
    for (const auto& [name, item] : value.items()) {
      *out << YAML::Key << name << YAML::Value;
      emit(item, depth + 1, out);
    }
    *out << YAML::EndMap;
  } else if (value.is_array()) {
    *out << style << YAML::BeginSeq;
    for (const Json& item : value) emit(item, 2, out);
    *out << YAML::EndSeq;
  } else if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (reads_as_other(text)) *out << YAML::DoubleQuoted;
    *out << text;
  } else {
    *out << value.dump();
  }
}

}  // namespace

std::string to_yaml(const Json& info) {
  YAML::Emitter out;
  emit(info, 0, &out);
  return concat(out.c_str(), "\n");
}

}  // namespace lte::datagen
