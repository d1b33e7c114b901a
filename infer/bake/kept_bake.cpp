#include "infer/bake/kept_bake.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "infer/bake/bake_parts.h"
#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/export.h"
#include "lte/scene/fingerprint.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kVersion = 1;
constexpr const char* kBakeAnew = "; bake without --since";

/// glTF has no environment, so that the two bakes must have one.
std::string environment_of(const scene::Scene& scene) {
  scene::Scene alone;
  alone.environment = scene.environment;
  return scene::fingerprint(alone).lights;
}

template <typename T>
std::vector<T> all_values(const SafetensorsFile& file, const char* tensor,
                          std::vector<int64_t> shape) {
  const std::span<const T> from = file.values<T>(tensor, shape);
  return {from.begin(), from.end()};
}

void check_settings(const std::string& folder, const BakeSettings& there,
                    const BakeSettings& here) {
  for (const auto& [name, value] : here) {
    const auto at = there.find(name);
    const std::string was = at == there.end() ? "" : at->second;
    LTE_CHECK(was == value, folder, ": was baked with ", name, " ", was.empty() ? "unset" : was,
              ", not ", value, kBakeAnew);
  }
}

}  // namespace

BakeSettings settings_of(const BakeRequest& r, const scene::Scene& scene) {
  return {{"include", r.include},
          {"integrator", r.integrator},
          {"quality", r.quality},
          {"depth", std::to_string(r.max_depth)},
          {"records", std::to_string(r.records)},
          {"seed", std::to_string(r.seed)},
          {"environment", environment_of(scene)}};
}

KeptBake read_kept(const BakeRequest& request, const scene::Scene& scene) {
  const fs::path folder = request.since;
  const BakeSettings settings = settings_of(request, scene);
  const fs::path path = folder / kKeptSamples;
  LTE_CHECK(fs::exists(path), folder.string(), ": has no ", kKeptSamples,
            ", which lte_bake --keep-samples leaves", kBakeAnew);
  const SafetensorsFile file(path);
  file.verify();
  KeptBake out;
  out.atlas.name = folder.string();
  size_t charts = 0;
  int64_t texels = 0;
  try {
    const Json json = Json::parse(file.metadata("bake"));
    LTE_CHECK(json.at("version") == kVersion, path.string(), ": is of another version of lte",
              kBakeAnew);
    check_settings(folder.string(), json.at("settings").get<BakeSettings>(), settings);
    out.atlas.width = json.at("width");
    out.atlas.height = json.at("height");
    out.atlas.texels_per_metre = json.at("texels_per_metre");
    out.atlas.kept_uvs = json.at("kept_uvs");
    out.atlas.objects = json.at("objects").get<std::vector<std::string>>();
    out.expected_error = json.at("expected_error");
    charts = json.at("charts");
    texels = json.at("texels");
  } catch (const Json::exception&) {
    throw Error(concat(path.string(), ": does not say how it was made", kBakeAnew));
  }
  const int64_t width = out.atlas.width, height = out.atlas.height;
  out.light.state =
      read_state(file, static_cast<size_t>(texels), charts, settings.at("include") == "full");
  out.light.pixel = all_values<int32_t>(file, "pixel", {texels});
  out.light.instance = all_values<int32_t>(file, "instance", {texels});
  out.light.chart = all_values<int32_t>(file, "chart", {texels});
  out.light.picture = all_values<float>(file, "picture", {height, width, 3});
  out.light.mask = all_values<uint8_t>(file, "mask", {height, width});
  out.atlas.scene = load_scene(folder / kKeptScene, request.loading);
  out.atlas.scene.environment = scene.environment;
  LTE_CHECK(out.atlas.scene.instances.size() == out.atlas.objects.size(), folder.string(), ": ",
            kKeptScene, " and ", kKeptSamples, " are not of one bake", kBakeAnew);
  const int64_t pixels = width * height;
  const auto objects = static_cast<int64_t>(out.atlas.objects.size());
  for (size_t i = 0; i < out.light.pixel.size(); ++i) {
    const bool inside = out.light.pixel[i] >= 0 && out.light.pixel[i] < pixels &&
                        out.light.instance[i] >= 0 && out.light.instance[i] < objects &&
                        out.light.chart[i] >= 0 && static_cast<size_t>(out.light.chart[i]) < charts;
    LTE_CHECK(inside, path.string(), ": texel ", i, " lies outside its atlas", kBakeAnew);
  }
  return out;
}

void write_kept(const ToKeep& keep, const bake::Lightmap& map, FileSet* files) {
  files->write(kKeptScene, [&](const fs::path& path) { scene::write_glb(path, map.scene); });
  files->write(kKeptSamples, [&](const fs::path& path) {
    const bake::OldLight& light = keep.light;
    SafetensorsWriter writer;
    StateCounts counts;
    add_state(light.state, &counts, &writer);
    const auto texels = static_cast<int64_t>(light.pixel.size());
    writer.add("pixel", {texels}, light.pixel.data());
    writer.add("instance", {texels}, light.instance.data());
    writer.add("chart", {texels}, light.chart.data());
    writer.add("picture", {map.height, map.width, 3}, map.layers[0].irradiance.data());
    writer.add("mask", {map.height, map.width}, map.mask.data());
    writer.set_metadata("bake", Json{{"version", kVersion},
                                     {"settings", keep.settings},
                                     {"width", map.width},
                                     {"height", map.height},
                                     {"texels_per_metre", map.provenance.texels_per_metre},
                                     {"kept_uvs", keep.kept_uvs},
                                     {"objects", keep.objects},
                                     {"expected_error", map.provenance.expected_error},
                                     {"charts", light.state.back.size()},
                                     {"texels", texels}}
                                    .dump());
    writer.write(path);
  });
}

}  // namespace lte::infer
