#include "infer/bake/bake_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/bake/bake_layers.h"
#include "infer/tool/assets.h"
#include "infer/tool/tool_keys.h"
#include "lte/bake/bake.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/formats/probe_files.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/cli/numbers.h"
#include "lte/cli/progress.h"
#include "lte/cli/writable.h"
#include "lte/embed/untrained_light.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

/// Bytes a texel beside those of its layers: fragments, places, neighbours, samples and means.
constexpr double kTexelBytes = 560, kLayerBytes = 36;
/// A light map less even than that in an EXR: of pixels, how many are texels.
constexpr double kAtlasUse = 0.7;

void check_usage(const BakeRequest& r) {
  const CLI::App& app = *r.flags;
  for (const char* flag : {"--checkpoint", "--embedding", "--save-embedding"}) {
    LTE_CHECK(app.count(flag) == 0 || r.needs_network(), flag,
              " goes with --integrator network: ", r.integrator, " needs no model");
  }
  for (const char* key : {"scene_points", "prune", "rescale", "device", "precision"}) {
    LTE_CHECK(!r.keys.is_given(key) || r.needs_network(), "--set ", key,
              " goes with --integrator network: ", r.integrator, " needs no model");
  }
  LTE_CHECK(!r.keys.is_given("records") || r.integrator != "path",
            "--set records goes with --integrator gather or network, not path");
  LTE_CHECK(!r.by_light || !r.needs_network(),
            "--by-light goes with --integrator gather or path, not network");
  LTE_CHECK(r.three.empty() == (r.format != "three"),
            "--format three and --three FILE, three.js as an ES module, go together");
  if (r.needs_network()) runtime::require_networks();
  LTE_CHECK(r.validate_only || !r.out.empty(), "--out: name the folder to write");
}

/// Before the work and not after it.
void check_folder(const std::string& out) {
  namespace fs = std::filesystem;
  fs::path there = fs::absolute(out);
  LTE_CHECK(!fs::exists(there) || fs::is_directory(there), out, ": --out is no folder");
  while (!fs::exists(there)) there = there.parent_path();
  check_writable((there / "lightmap.json").string());
}

/// @throws runtime::NotEnoughMemory before any of it is taken
void check_memory(const BakeRequest& request, const scene::Scene& scene,
                  const runtime::MemoryLimit& memory) {
  const double texels =
      request.atlas.size > 0
          ? std::pow(static_cast<double>(request.atlas.size), 2) * kAtlasUse
          : scene::surface_area(scene) * std::pow(request.atlas.texels_per_metre, 2);
  const double layers =
      request.by_light ? static_cast<double>(std::max<size_t>(1, scene.light_groups.size())) : 1;
  memory.check_ahead(
      texels / kAtlasUse * (kTexelBytes + layers * kLayerBytes) / (1 << 20),
      concat("a light map of about ", static_cast<int64_t>(texels), " texels and ", layers,
             layers == 1 ? " layer" : " layers"),
      request.by_light
          ? "bake without --by-light, or with fewer texels (--texels-per-metre, --size)"
          : "take fewer texels (--texels-per-metre, --size)");
}

std::optional<runtime::Network> load_network(const BakeRequest& request, const Renderer& renderer) {
  if (!request.needs_network()) return std::nullopt;
  runtime::Network network(checkpoint_or_shipped(request.checkpoint),
                           network_options(request.tool));
  network.check_fits(max_component(scene::point_bounds(renderer.bvh().scene()).extent()),
                     request.embedding.rescale);
  return network;
}

/// The scene as the network reads it. Warns of light in it that the network does not know.
EmbedSettings settings_for(const BakeRequest& request, const runtime::Network& network,
                           const bake::Texels& texels, const Renderer& renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed,
                                          runtime::MemoryLimit(request.tool.max_memory_mb));
  cull_lights(request.embedding, renderer.bvh(), network,
              embed::SurfacePlaces{texels.position, texels.normal}, &settings);
  const std::string note = embed::untrained_light_note(renderer.bvh().scene(), network.metadata(),
                                                       settings.culled_lights);
  if (!note.empty()) log_warning(note);
  return settings;
}

void write_gltf(const bake::Lightmap& map, FileSet* files) {
  files->write("lightmap.exr",
               [&](const std::filesystem::path& path) { bake::write_lightmap_exr(path, map); });
  files->write("lightmap.json", [&](const std::filesystem::path& path) {
    bake::write_lightmap_json(path, map, "lightmap.exr");
  });
  files->write("scene.glb",
               [&](const std::filesystem::path& path) { bake::write_lightmap_glb(path, map); });
  files->write("scene_unlit.glb",
               [&](const std::filesystem::path& path) { bake::write_unlit_glb(path, map); });
}

std::optional<bake::ProbeVolume> probes_of(const BakeRequest& request, const Renderer& renderer) {
  if (request.probes.empty()) return std::nullopt;
  bake::ProbeOptions options;
  options.max_depth = request.max_depth;
  options.direct = request.include == "full";
  options.seed = request.seed;
  const bake::ProbeGrid grid = bake::parse_probe_grid(request.probes, renderer.bvh().bounds());
  Progress progress("probes", grid.size(), "probes");
  options.done = [&](int64_t count) { progress.advance(count); };
  return bake::bake_probes(renderer.bvh(), renderer.lights(), grid, options);
}

void write(const BakeRequest& request, const bake::Lightmap& map,
           const std::optional<bake::ProbeVolume>& probes) {
  FileSet files(request.out);
  const auto formats = bake::engine_formats();
  const auto format = std::find_if(formats.begin(), formats.end(), [&](const bake::Format& one) {
    return one.name == request.format;
  });
  if (format == formats.end()) {
    write_gltf(map, &files);
  } else {
    bake::FormatOptions options;
    options.three = request.three;
    options.probes = probes ? &*probes : nullptr;
    format->write(map, options, &files);
  }
  if (probes) bake::write_probes(*probes, &files);
  files.commit();
}

void say(const BakeRequest& request, const bake::Lightmap& map, double seam) {
  std::array<int64_t, 4> counts{};
  for (const uint8_t texel : map.mask) ++counts[texel];
  const bake::Provenance& p = map.provenance;
  log_info(request.out, ": ", map.width, " x ", map.height, ", ", counts[1], " lit texels and ",
           counts[3], " dark ones in ", p.seconds, " s, expected error ", 100 * p.expected_error,
           " %");
  if (p.two_sided_texels > 0)
    log_info(p.two_sided_texels, " texels are lit on both sides; the brighter was baked");
  if (p.metal_instances > 0)
    log_info(p.metal_instances, " of ", map.placements.size(),
             " surfaces are metal and were baked as matt");
  if (request.tool.common.json.empty()) return;
  const nlohmann::json json = {{"schema_version", 1},
                               {"scene", request.scene},
                               {"out", request.out},
                               {"size", {map.width, map.height}},
                               {"integrator", request.integrator},
                               {"lit_texels", counts[1]},
                               {"filled_texels", counts[2]},
                               {"dark_texels", counts[3]},
                               {"two_sided_texels", p.two_sided_texels},
                               {"paths_per_texel", p.paths_per_texel},
                               {"expected_error", p.expected_error},
                               {"seam_p99", seam},
                               {"seconds", p.seconds},
                               {"peak_rss_mb", peak_rss_mb()}};
  write_file(request.tool.common.json, json.dump(2) + "\n");
}

void check_lit(const BakeRequest& request, const bake::Lightmap& map) {
  const bool lit = std::find(map.mask.begin(), map.mask.end(),
                             static_cast<uint8_t>(bake::Texel::Lit)) != map.mask.end();
  LTE_CHECK(lit, request.scene, ": light reaches no texel, so there is nothing to bake");
}

void add_light_options(CLI::App& app, BakeRequest* r) {
  app.add_option("--include", r->include,
                 "full: all light; indirect: what surfaces have reflected, for engines that light "
                 "by lamps of their own")
      ->check(CLI::IsMember({"indirect", "full"}))
      ->capture_default_str();
  app.add_flag("--by-light", r->by_light,
               "A layer a light group: their sum is all light, so a lamp dims without a bake");
  app.add_option("--integrator", r->integrator,
                 "How light is computed. gather: rays from texels read path-traced light in an "
                 "irradiance cache; network: they read light that the network knows there; path: "
                 "path tracing alone, without bias")
      ->check(CLI::IsMember({"gather", "network", "path"}))
      ->capture_default_str();
  CLI::Option* const quality =
      app.add_option("--quality", r->quality,
                     "How long it takes: draft, preview or final (with paths that correct "
                     "gathered light)")
          ->check(CLI::IsMember({"draft", "preview", "final"}))
          ->capture_default_str();
  app.add_option("--time", r->time, "Passes until such a time is over, as 6s or 500ms")
      ->check(a_time())
      ->excludes(quality);
  app.add_option("--error", r->error, "Passes until noise is at such a share of the light, as 0.05")
      ->check(positive_number())
      ->excludes(quality);
  app.add_option("--checkpoint", r->checkpoint,
                 "Model, with --integrator network; by default lte-hybrid");
  add_embedding_flags(app, &r->embedding);
  app.add_option("--seed", r->seed, "Seed of all samples")->capture_default_str();
}

}  // namespace

void add_bake_options(CLI::App& app, BakeRequest* r) {
  std::vector<std::string> formats{"gltf"};
  for (const bake::Format& format : bake::engine_formats()) formats.emplace_back(format.name);
  app.add_option("scene", r->scene, "Scene: .gltf, .glb, .pbrt, .obj or .ply")->required();
  app.add_option("--out", r->out, "Folder to write; its files appear all or none");
  CLI::Option* const density =
      app.add_option("--texels-per-metre", r->atlas.texels_per_metre, "Texels along a metre")
          ->check(positive_number())
          ->capture_default_str();
  app.add_option("--size", r->atlas.size, "Edge of the picture instead")
      ->check(CLI::Range(16, bake::kMaxAtlas))
      ->excludes(density);
  app.add_flag("--keep-uvs", r->atlas.keep_uvs,
               "Take TEXCOORD_1 as it is, or fail; without it, where it overlaps or is missing, "
               "charts are made");
  add_light_options(app, r);
  app.add_option("--format", r->format,
                 "What is written. gltf: EXR, JSON, a GLB with MOZ_lightmap and an unlit GLB")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  app.add_option("--three", r->three, "With --format three: three.js as an ES module")
      ->check(CLI::ExistingFile);
  app.add_option("--probes", r->probes, "Probes of a grid, too: auto or NXxNYxNZ");
  r->flags = &app;
  r->keys.add("depth", &r->max_depth, 1, 1000, "surface hits of light's path after the texel");
  r->keys.add("records", &r->records, 2, int64_t{1} << 22,
              "of gather and network: places that the irradiance cache knows");
  add_scene_keys(&r->keys, r);
  add_embedding_keys(&r->keys, &r->embedding);
  add_network_keys(&r->keys, &r->tool);
  r->keys.add_to(&app);
  app.parse_complete_callback([r] { r->keys.read(); });
  app.add_flag("--validate-only", r->validate_only, "Check scene, atlas and flags, and stop");
  add_scene_options(app, r);
  add_plain_tool_options(app, &r->tool);
}

void run_bake(const BakeRequest& request) {
  check_usage(request);
  CommandFiles files;
  claim_scene(request, &files);
  claim_embedding(request.embedding, &files);
  files.reads("--checkpoint", request.checkpoint);
  files.reads("--three", request.three);
  files.writes_common(request.tool.common);
  files.check();
  apply_tool_options(request.tool);
  check_writable(request.tool.common.json);
  check_writable(request.embedding.save);
  if (!request.validate_only) check_folder(request.out);
  const scene::Scene scene = load_source(request);
  describe(scene, request.scene);
  const Timer timer;
  Renderer renderer(scene);
  LTE_CHECK(renderer.has_light(), request.scene,
            ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  pathtrace::warn_of_lost_light(request.scene, renderer.bvh());
  files.check_what_was_read();
  check_memory(request, scene, runtime::MemoryLimit(request.tool.max_memory_mb));
  bake::Layout layout = bake::make_layout(scene, request.atlas);
  log_info("atlas: ", layout.atlas.width, " x ", layout.atlas.height, ", ", layout.texels.size(),
           " texels in ", layout.atlas.charts, " charts",
           layout.atlas.kept_uvs ? ", the scene's own TEXCOORD_1" : "");
  if (layout.atlas.lost_triangles > 0)
    log_info(layout.atlas.lost_triangles, " triangles have no area and no texels");
  if (request.validate_only) {
    std::printf("%s: valid scene, %zu texels\n", request.scene.c_str(), layout.texels.size());
    return;
  }
  const std::optional<runtime::Network> network = load_network(request, renderer);
  EmbedSettings settings;
  if (network) settings = settings_for(request, *network, layout.texels, renderer);
  std::vector<bake::BakedLayer> layers = bake_layers(request, network ? &*network : nullptr,
                                                     settings, layout, timer.seconds(), &renderer);
  bake::Provenance provenance;
  provenance.source = request.scene;
  provenance.integrator = request.integrator;
  if (network) provenance.model = checkpoint_or_shipped(request.checkpoint).filename().string();
  provenance.include = request.include;
  provenance.seed = request.seed;
  for (const bake::BakedLayer& layer : layers)
    provenance.expected_error = std::max(provenance.expected_error, layer.light.expected_error);
  provenance.paths_per_texel = layers.front().light.paths;
  double seam = 0;
  bake::Lightmap map = bake::make_lightmap(renderer.bvh(), std::move(layout), std::move(layers),
                                           std::move(provenance), &seam);
  check_lit(request, map);
  map.provenance.seconds = timer.seconds();
  const std::optional<bake::ProbeVolume> probes = probes_of(request, renderer);
  write(request, map, probes);
  say(request, map, seam);
}

}  // namespace lte::infer
