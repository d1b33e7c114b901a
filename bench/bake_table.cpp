#include "bench/bake_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "bench/bake_rivals.h"
#include "bench/begin_command.h"
#include "infer/bake/bake_layers.h"
#include "infer/tool/tool_options.h"
#include "lte/bake/bake.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/version.h"
#include "lte/cli/numbers.h"
#include "lte/scene/sampler.h"

namespace lte::bench {
namespace {

using namespace infer;

/// As many paths of Cycles as the most of our own.
constexpr int kCyclesSamples = 64;

BakeRow product(MeasuredScene* m, Quality quality, uint64_t seed) {
  const Stopwatch watch;
  const auto texels = static_cast<double>(m->layout.texels.size());
  bake::LightOptions options = quality_options(quality, texels);
  options.seed = seed;
  render::CacheSettings cache;
  cache.records = bake::record_count(texels, options);
  cache.paths = bake::record_paths(texels, cache.records, options);
  cache.seed = seed;
  const auto integrator = render::make_gather(m->traced(), cache);
  integrator->prepare();
  // Where both sides are lit, chance says which is brighter.
  const bake::Sides sides{m->sides.back, 0};
  options.sides = &sides;
  std::vector<bake::BakedLayer> layers;
  layers.push_back({"light", bake::light_texels(m->traced(), *integrator, m->layout.atlas,
                                                m->layout.texels, options)});
  double seam = 0;
  const bake::Lightmap map =
      bake::make_lightmap(m->renderer.bvh(), m->layout, std::move(layers), {}, &seam);
  return measure_picture(*m, concat("bake ", enum_name(quality)), watch.seconds(),
                         map.layers[0].irradiance, map.mask);
}

/// As many texels as were asked for, about: charts' edges take more than their area does.
void lay_out(const BakeTableRequest& request, MeasuredScene* m) {
  bake::AtlasOptions atlas;
  atlas.texels_per_metre = std::sqrt(request.texels / scene::surface_area(m->scene));
  for (int k = 0; k < 2; ++k) {
    const Stopwatch watch;
    m->layout = bake::make_layout(m->scene, atlas);
    m->layout_seconds = watch.seconds();
    atlas.texels_per_metre *=
        std::sqrt(request.texels / static_cast<double>(m->layout.texels.size()));
  }
}

void prepare(const BakeTableRequest& request, MeasuredScene* m) {
  lay_out(request, m);
  const bake::Texels& texels = m->layout.texels;
  const auto gather = render::make_gather(m->traced(), {});
  gather->prepare();
  bake::LightOptions draft;
  draft.passes = 2;
  m->sides = bake::light_texels(m->traced(), *gather, m->layout.atlas, texels, draft);
  m->normals = bake::turned_normals(texels, m->sides.back);
  m->mask = bake::make_mask(m->renderer.bvh(), m->layout.atlas, texels, m->sides);
  const size_t step = std::max<size_t>(1, texels.size() / static_cast<size_t>(request.measured));
  Rng rng(request.seed, 91);
  for (size_t i = rng.below(step); i < texels.size(); i += step)
    m->which.push_back(static_cast<uint32_t>(i));
  bake::LightOptions reference;
  reference.rays = 16;
  reference.passes = std::max(1, request.reference_paths / reference.rays / 2);
  for (uint64_t k = 0; k < 2; ++k) {
    reference.seed = hash_combine(hash_combine(request.seed, 92), k);
    m->truth[k] = bake::trace_texels(m->traced(), m->layout.atlas, texels, m->sides.back, m->which,
                                     reference);
  }
}

std::vector<BakeRow> measure_all(const BakeTableRequest& request, MeasuredScene* m) {
  std::vector<BakeRow> rows;
  for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final})
    rows.push_back(product(m, quality, request.seed));
  add_network(request.checkpoint, request.seed, m, &rows);
  add_paths(*m, 16, 2, request.seed, &rows);
  add_paths(*m, 64, 1, request.seed, &rows);
  if (!request.cycles.empty()) add_cycles(*m, request.cycles, kCyclesSamples, request.seed, &rows);
  return rows;
}

void print(const std::string& file, size_t texels, const std::vector<BakeRow>& rows) {
  std::printf("%s: %zu texels\n%-20s %8s %8s %8s %7s %7s %7s %7s %7s\n", file.c_str(), texels, "",
              "seconds", "CPU s", "relMSE", "bias", "median", "p95", "leak", "seam");
  for (const BakeRow& row : rows) {
    std::printf("%-20s %8.2f %8.2f %8.4f %6.1f%% %6.1f%% %6.1f%% %7.4f %6.2f%%\n", row.name.c_str(),
                row.seconds.wall, row.seconds.processor, row.rel_mse, 100 * row.bias,
                100 * row.median, 100 * row.p95, row.leak, 100 * row.seam);
  }
  std::fflush(stdout);
}

/// What the file of an earlier run has, if its settings are these; else no scene.
nlohmann::json results_so_far(const BakeTableRequest& request, const std::string& path) {
  const nlohmann::json settings = {{"texels", request.texels},
                                   {"measured", request.measured},
                                   {"reference_paths", request.reference_paths},
                                   {"checkpoint", request.checkpoint},
                                   {"cycles", !request.cycles.empty()},
                                   {"seed", request.seed},
                                   {"version", version()}};
  if (request.resume && std::filesystem::exists(path)) {
    nlohmann::json there = nlohmann::json::parse(read_file(path), nullptr, false);
    LTE_CHECK(there.is_object() && there.contains("settings") && there.contains("scenes"), path,
              ": --resume: is no file of lte_bench bake");
    if (there["settings"] == settings) return there;
    log_warning(path, ": was measured with other settings, and is written anew");
  }
  return {{"schema_version", 1}, {"settings", settings}, {"scenes", nlohmann::json::array()}};
}

bool has_scene(const nlohmann::json& json, const std::string& file) {
  const nlohmann::json& rows = json["scenes"];
  return std::any_of(rows.begin(), rows.end(),
                     [&](const nlohmann::json& row) { return row["scene"] == file; });
}

}  // namespace

void add_bake_table_options(CLI::App& command, BakeTableRequest* request) {
  command.add_option("SCENE", request->scenes, "Scene files")->required();
  command.add_option("--texels", request->texels, "Texels of each light map, about")
      ->check(CLI::Range(100, 100000000))
      ->capture_default_str();
  command.add_option("--measured", request->measured, "Texels that the reference knows")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--reference-paths", request->reference_paths, "Paths of each of those")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--checkpoint", request->checkpoint, "Model; by default the shipped one");
  command.add_option("--cycles", request->cycles,
                     "Also a row of Blender's Cycles: a Python that has bpy");
  command.add_option("--seed", request->seed, "Seed of all samples")->capture_default_str();
  command.add_flag("--resume", request->resume,
                   "Keep the scenes that the file of --json has, measured with the same flags");
  add_scene_flags(command, &request->loading);
}

void run_bake_table(const BakeTableRequest& request, const CommonOptions& common) {
  CommandFiles files;
  for (const std::string& scene : request.scenes) files.reads("SCENE", scene);
  begin_command(common, &files);
  LTE_CHECK(!request.resume || !common.json.empty(), "--resume goes with --json");
  nlohmann::json json = results_so_far(request, common.json);
  for (const std::string& file : request.scenes) {
    if (has_scene(json, file)) continue;
    const scene::Scene scene = load_scene(file, request.loading);
    MeasuredScene m(scene);
    prepare(request, &m);
    const std::vector<BakeRow> rows = measure_all(request, &m);
    print(file, m.layout.texels.size(), rows);
    for (const BakeRow& row : rows) {
      json["scenes"].push_back({{"scene", file},
                                {"method", row.name},
                                {"texels", m.layout.texels.size()},
                                {"seconds", row.seconds.wall},
                                {"processor_seconds", row.seconds.processor},
                                {"rel_mse", row.rel_mse},
                                {"bias", row.bias},
                                {"median", row.median},
                                {"p95", row.p95},
                                {"leak", row.leak},
                                {"seam", row.seam}});
    }
    if (!common.json.empty()) write_file(common.json, json.dump(2) + "\n");
  }
}

}  // namespace lte::bench
