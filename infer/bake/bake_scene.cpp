#include "infer/bake/bake_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <utility>

#include "infer/bake/bake_layers.h"
#include "infer/bake/bake_parts.h"
#include "infer/renderer/made_with.h"
#include "lte/bake/bake.h"
#include "lte/bake/formats/probe_files.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/progress.h"

namespace lte::infer {
namespace {

/// Bytes a texel beside those of its layers: fragments, places, neighbours, samples and means, and
/// what a denoiser takes.
constexpr double kTexelBytes = 900, kLayerBytes = 36;
/// Bytes a vertex and layer of vertex-colors: as fitted, of meshes, and in the file.
constexpr double kVertexBytes = 36;
/// Flags that change no sample.
const std::set<std::string> kNoMatter = {"format", "three", "probes", "shard", "keep-samples"};

/// Vertices of the light of vertex-colors at least; 0 for other formats.
double lit_vertices(const BakeRequest& request, const scene::Scene& scene) {
  double out = 0;
  if (request.format != "vertex-colors") return out;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    out += static_cast<double>(mesh.positions.size());
  }
  return out;
}

/// @throws runtime::NotEnoughMemory before any of it is taken
void check_memory(const BakeRequest& request, const scene::Scene& scene,
                  const runtime::MemoryLimit& memory) {
  const double texels = expected_texels(request, scene);
  const double layers =
      request.by_light ? static_cast<double>(std::max<size_t>(1, scene.light_groups.size())) : 1;
  const double bytes = texels / kAtlasUse * (kTexelBytes + layers * kLayerBytes) +
                       lit_vertices(request, scene) * layers * kVertexBytes;
  memory.check_ahead(
      bytes / (1 << 20),
      concat("a light map of about ", static_cast<int64_t>(texels), " texels and ", layers,
             layers == 1 ? " layer" : " layers"),
      request.by_light
          ? "bake without --by-light, or with fewer texels (--texels-per-metre, --size)"
          : "take fewer texels (--texels-per-metre, --size)");
}

void write_gltf(const bake::Lightmap& map, FileSet* files) {
  using Path = std::filesystem::path;
  files->write_all(
      {{"scene.glb", [&](const Path& path) { bake::write_lightmap_glb(path, map); }},
       {"scene_unlit.glb", [&](const Path& path) { bake::write_unlit_glb(path, map); }},
       {"lightmap.exr", [&](const Path& path) { bake::write_lightmap_exr(path, map); }},
       {"lightmap.json",
        [&](const Path& path) { bake::write_lightmap_json(path, map, "lightmap.exr"); }}});
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

void check_lit(const BakeRequest& request, const bake::Lightmap& map) {
  const bool lit = std::find(map.mask.begin(), map.mask.end(),
                             static_cast<uint8_t>(bake::Texel::Lit)) != map.mask.end();
  LTE_CHECK(lit, request.scene, ": light reaches no texel, so there is nothing to bake");
}

/// Of what a later bake goes on with, and of what this one would go on with.
void check_since(const BakeRequest& r) {
  if (!r.keep_samples && r.since.empty()) return;
  const char* const flag = r.since.empty() ? "--keep-samples" : "--since";
  LTE_CHECK(!r.by_light && !r.needs_network(), flag,
            " goes with --integrator gather or path, and without --by-light");
  LTE_CHECK(r.time.empty() && r.error <= 0, flag,
            " goes with --quality: how far --time and --error get is chance");
  LTE_CHECK(r.since.empty() || (!r.resume && r.shard.empty()),
            "--since is a bake of its own, without --resume and --shard");
}

/// All but the settings.
ToKeep to_keep(const scene::Scene& scene, const bake::Layout& layout, bake::LightState state) {
  ToKeep out;
  out.kept_uvs = layout.atlas.kept_uvs;
  out.objects = bake::mesh_fingerprints(scene);
  out.light.state = std::move(state);
  out.light.state.graph.reset();
  const bake::Texels& texels = layout.texels;
  out.light.pixel.assign(texels.pixel.begin(), texels.pixel.end());
  out.light.chart = texels.chart;
  for (size_t i = 0; i < texels.size(); ++i)
    out.light.instance.push_back(texels.fragments[texels.first[i]].instance);
  return out;
}

}  // namespace

std::optional<BakedScene> bake_scene(const BakeRequest& request, Renderer* renderer) {
  const Timer timer;
  const scene::Scene& scene = renderer->bvh().scene();
  LTE_CHECK(renderer->has_light(), request.scene,
            ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  check_since(request);
  if (request.since.empty())  // whose atlas was baked here before
    check_memory(request, scene, runtime::MemoryLimit(request.tool.max_memory_mb));
  std::optional<PreparedIntegrator> prepared;
  if (!request.validate_only)
    prepared.emplace(request, render::TracedScene{renderer->bvh(), renderer->lights()});
  std::optional<KeptBake> old;
  bake::Relayout relayout;
  bake::Layout& layout = relayout.layout;
  if (request.since.empty()) {
    layout = bake::make_layout(scene, request.atlas);
  } else {
    old = read_kept(request, scene);
    relayout = bake::lay_out_again(scene, old->atlas);
  }
  log_info("atlas: ", layout.atlas.width, " x ", layout.atlas.height, ", ", layout.texels.size(),
           " texels in ", layout.atlas.charts, " charts",
           layout.atlas.kept_uvs ? ", the scene's own TEXCOORD_1" : "");
  if (layout.atlas.lost_triangles > 0)
    log_info(layout.atlas.lost_triangles, " triangles have no area and no texels");
  if (request.validate_only) {
    std::printf("%s: valid scene, %zu texels\n", request.scene.c_str(), layout.texels.size());
    return std::nullopt;
  }
  std::optional<runtime::Network> network;
  EmbedSettings settings;
  if (request.needs_network()) {
    network = load_network(request, scene);
    settings = embed_settings(request, *network,
                              embed::SurfacePlaces{layout.texels.position, layout.texels.normal},
                              *renderer);
  }
  const runtime::Network* const model = network ? &*network : nullptr;
  std::optional<BakeParts> parts;
  if (request.flags != nullptr)
    parts.emplace(request.out, made_with(*request.flags, scene, model, kNoMatter));
  BakedScene out;
  if (request.resume && request.shard.empty()) out.shards = std::max(1, parts->shards());
  std::optional<SinceBake> since;
  if (old) since.emplace(SinceBake{*old, relayout, {}});
  const bool keeps = request.keep_samples || old;
  bake::LightState state;
  std::vector<bake::BakedLayer> layers = bake_layers(
      request, model, settings, layout, &*prepared, timer.seconds(), parts ? &*parts : nullptr,
      since ? &*since : nullptr, keeps ? &state : nullptr, renderer);
  if (layers.empty()) {
    log_info(request.out, ": shard ", request.shard, " in ", timer.seconds(),
             " s; --resume joins all of them");
    return std::nullopt;
  }
  bake::Provenance provenance;
  provenance.source = request.scene;
  provenance.integrator = request.integrator;
  if (network) provenance.model = checkpoint_or_shipped(request.checkpoint).filename().string();
  provenance.include = request.include;
  provenance.seed = request.seed;
  for (const bake::BakedLayer& layer : layers)
    provenance.expected_error = std::max(provenance.expected_error, layer.light.expected_error);
  provenance.paths_per_texel = layers.front().light.paths;
  if (keeps) {
    out.keep = to_keep(scene, layout, std::move(state));
    out.keep->settings = settings_of(request, scene);
  }
  out.map = bake::make_lightmap(renderer->bvh(), since ? layout : std::move(layout),
                                std::move(layers), std::move(provenance), &out.seam_p99);
  if (since) {
    const std::vector<uint8_t>& changed = since->kept.changed;
    bake::restore_kept(layout, old->light, since->kept, &out.map);
    out.map.provenance.kept_texels = std::count(changed.begin(), changed.end(), 0);
  }
  check_lit(request, out.map);
  out.map.provenance.seconds = timer.seconds();
  out.probes = probes_of(request, *renderer);
  return out;
}

void write_baked(const BakedScene& baked, const std::string& format_name,
                 bake::FormatOptions options, const std::filesystem::path& folder) {
  LTE_CHECK(options.three.empty() == (format_name != "three"),
            "the format three and the file three.js as an ES module go together");
  FileSet files(folder);
  const auto formats = bake::engine_formats();
  const auto format = std::find_if(formats.begin(), formats.end(), [&](const bake::Format& one) {
    return one.name == format_name;
  });
  if (format == formats.end()) {
    write_gltf(baked.map, &files);
  } else {
    options.probes = baked.probes ? &*baked.probes : nullptr;
    format->write(baked.map, options, &files);
  }
  if (baked.probes) bake::write_probes(*baked.probes, &files);
  if (baked.keep) write_kept(*baked.keep, baked.map, &files);
  files.commit();
}

}  // namespace lte::infer
