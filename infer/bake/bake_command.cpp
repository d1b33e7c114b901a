#include "infer/bake/bake_command.h"

#include <array>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "infer/bake/bake_parts.h"
#include "infer/bake/bake_scene.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"
#include "lte/pathtrace/reach/lost_light.h"

namespace lte::infer {
namespace {

void check_usage(const BakeRequest& r) {
  check_light_used(r, {"records"});
  const char* const vertex = first_set(r.keys, {"bend", "max_triangles"});
  LTE_CHECK(vertex == nullptr || r.format == "vertex-colors", "--set ", vertex,
            " goes with --format vertex-colors");
  LTE_CHECK(!r.by_light || !r.needs_network(),
            "--by-light goes with --integrator gather or path, not network");
  LTE_CHECK(r.files.three.empty() == (r.format != "three"),
            "--format three and --three FILE, three.js as an ES module, go together");
  const char* const whole = first_given(*r.flags, {"--resume", "--shard"});
  LTE_CHECK(whole == nullptr || (r.time.empty() && r.error <= 0), whole,
            " goes with --quality: how far --time and --error get is chance");
  if (!r.shard.empty()) parse_shard(r.shard);
  const char* const atlas = first_given(*r.flags, {"--texels-per-metre", "--size"});
  LTE_CHECK(atlas == nullptr || r.since.empty(), atlas, ": --since keeps the atlas of ", r.since);
  LTE_CHECK(first_set(r.keys, {"change"}) == nullptr || !r.since.empty(),
            "--set change goes with --since");
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

void say(const BakeRequest& request, const bake::Lightmap& map, double seam) {
  std::array<int64_t, 4> counts{};
  for (const uint8_t texel : map.mask) ++counts[texel];
  const bake::Provenance& p = map.provenance;
  log_info(request.out, ": ", map.width, " x ", map.height, ", ", counts[1], " lit texels and ",
           counts[3], " dark ones in ", p.seconds, " s, expected error ", 100 * p.expected_error,
           " %");
  if (p.kept_texels > 0) log_info(p.kept_texels, " texels are those of ", request.since);
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
                               {"kept_texels", p.kept_texels},
                               {"paths_per_texel", p.paths_per_texel},
                               {"expected_error", p.expected_error},
                               {"seam_p99", seam},
                               {"seconds", p.seconds},
                               {"peak_rss_mb", peak_rss_mb()}};
  write_file(request.tool.common.json, json.dump(2) + "\n");
}

void add_light_options(CLI::App& app, BakeRequest* r) {
  app.add_option("--include", r->include,
                 "full: all light; indirect: what surfaces have reflected, for engines that light "
                 "by lamps of their own")
      ->check(CLI::IsMember({"indirect", "full"}))
      ->capture_default_str();
  app.add_flag("--by-light", r->by_light,
               "A layer a light group: their sum is all light, so a lamp dims without a bake");
  add_light_flags(app, "each texel", r);
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
  add_light_options(app, r);
  app.add_option("--format", r->format,
                 "What is written. gltf: EXR, JSON, a GLB with MOZ_lightmap and an unlit GLB; "
                 "vertex-colors: a GLB with the light in COLOR_0 and no picture")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  app.add_option("--three", r->files.three, "With --format three: three.js as an ES module")
      ->check(CLI::ExistingFile);
  app.add_option("--probes", r->probes, "Probes of a grid, too: auto or NXxNYxNZ");
  app.add_flag("--resume", r->resume,
               "Go on with a bake that was stopped, or join shards: the same bytes as of one run");
  app.add_flag("--keep-samples", r->keep_samples,
               "Leave what a later --since goes on with in --out, too");
  app.add_option(
         "--since", r->since,
         "Bake anew only what has changed since the bake in this folder, of the same flags; "
         "may be that of --out")
      ->check(CLI::ExistingDirectory);
  app.add_option("--shard", r->shard,
                 "Bake one of N shards, for processes that share the work: leaves its part in "
                 "--out, where --resume joins them")
      ->type_name("I/N");
  add_light_keys("the texel", r);
  r->keys.add("keep_every", &r->keep_every, 0, 1e9,
              "seconds between two times at which what is sampled is kept for --resume");
  r->keys.add(
      "change", &r->change, 1e-4, 1,
      "of --since: texels are baked anew where light has changed, or may have, by more than "
      "this share of it");
  r->keys.add("keep_uvs", &r->atlas.keep_uvs,
              "take TEXCOORD_1 as it is, or fail; off: where it overlaps or is missing, charts are "
              "made");
  r->keys.add("bend", &r->files.vertex.bend, 1e-3, 10,
              "of vertex-colors: triangles are cut until linear interpolation is off by less than "
              "this share of the light, of each layer and of all");
  r->keys.add("max_triangles", &r->files.vertex.max_triangles, 1, int64_t{1} << 28,
              "of vertex-colors: triangles at most");
  app.add_flag("--validate-only", r->validate_only, "Check scene, atlas and flags, and stop");
  add_tool_flags(app, r);
}

void run_bake(const BakeRequest& request) {
  check_usage(request);
  CommandFiles files;
  claim_light_files(request, &files);
  files.reads("--three", request.files.three);
  files.check();
  apply_tool_options(request.tool);
  check_writable(request.tool.common.json);
  if (!request.validate_only) check_folder(request.out);
  const scene::Scene scene = load_source(request);
  describe(scene, request.scene);
  Renderer renderer(scene);
  pathtrace::warn_of_lost_light(request.scene, renderer.bvh());
  files.check_what_was_read();
  const std::optional<BakedScene> baked = bake_scene(request, &renderer);
  if (!baked) return;
  write_baked(*baked, request.format, request.files, request.out);
  BakeParts(request.out, {}).remove(baked->shards);
  say(request, baked->map, baked->seam_p99);
}

}  // namespace lte::infer
