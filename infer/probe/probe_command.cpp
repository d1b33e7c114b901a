#include "infer/probe/probe_command.h"

#include <cstdio>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/check/check_report.h"
#include "infer/probe/probe_answers.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/tool_keys.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"
#include "lte/embed/culled_lights.h"
#include "lte/embed/untrained_light.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"

namespace lte::infer {
namespace {

void check_usage(const ProbeRequest& r) {
  const CLI::App& app = *r.flags;
  LTE_CHECK(r.error == 0 || r.by_paths(), "--error goes with --integrator path, not ",
            r.integrator);
  for (const char* flag : {"--checkpoint", "--embedding", "--save-embedding"}) {
    LTE_CHECK(app.count(flag) == 0 || r.needs_network(), flag,
              " goes with --integrator network: ", r.integrator, " needs no model");
  }
  for (const char* key : {"scene_points", "prune", "rescale", "device", "precision"}) {
    LTE_CHECK(!r.keys.is_given(key) || r.needs_network(), "--set ", key,
              " goes with --integrator network: ", r.integrator, " needs no model");
  }
  for (const char* key : {"records", "check"}) {
    LTE_CHECK(!r.keys.is_given(key) || !r.by_paths(), "--set ", key,
              " goes with --integrator gather or network, not path");
  }
  if (r.validate_only) return;
  LTE_CHECK(!r.points.empty(), "--points: name a CSV file with the header px,py,pz,nx,ny,nz");
  LTE_CHECK(!r.out.empty(), "--out: name the CSV file to write");
}

/// The scene as the network reads it. Warns of light in it that the network does not know.
EmbedSettings settings_for(const ProbeRequest& request, const runtime::Network& network,
                           const scene::PointTable& points, const Renderer& renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed,
                                          runtime::MemoryLimit(request.tool.max_memory_mb));
  cull_lights(request.embedding, renderer.bvh(), network,
              embed::SurfacePlaces{points.position, points.normal}, &settings);
  const std::string note = embed::untrained_light_note(renderer.bvh().scene(), network.metadata(),
                                                       settings.culled_lights);
  if (!note.empty()) log_warning(note);
  return settings;
}

scene::PointColumns columns_of(const ProbeAnswer& answer) {
  scene::PointColumns columns = probe_columns(answer.light);
  if (answer.expected_error.empty()) return columns;
  columns.names.push_back("expected_error");
  for (size_t i = 0; i < columns.rows.size(); ++i)
    columns.rows[i].push_back(answer.expected_error[i]);
  return columns;
}

void say(const ProbeRequest& request, const ProbeAnswer& answer, size_t points) {
  if (answer.light.missed > 0)
    log_warning(answer.light.missed, " of ", points, " points are above --error ", request.error,
                "; raise --spp above ", rays_of(request));
  const std::string note = check_note(
      answer.check, request.needs_network() ? "the network's" : "the gathered", "the points");
  if (!note.empty()) log_warning(request.points, ": ", note);
}

void write(const ProbeRequest& request, const scene::PointTable& points, const ProbeAnswer& answer,
           double seconds) {
  scene::write_point_table(request.out, points, columns_of(answer));
  log_info(request.out, ": ", points.size(), " points in ", seconds, " s");
  if (request.tool.common.json.empty()) return;
  const nlohmann::json json = {{"scene", request.scene},
                               {"integrator", request.integrator},
                               {"points", points.size()},
                               {"above_target", answer.light.missed},
                               {"left_out_lights", answer.culled_lights},
                               {"check", check_json(answer.check)},
                               {"seconds", seconds}};
  write_file(request.tool.common.json, json.dump(2) + "\n");
}

void claim_files(const ProbeRequest& request, CommandFiles* files) {
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--points", request.points);
  files->reads("--checkpoint", request.checkpoint);
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

std::optional<runtime::Network> load_network(const ProbeRequest& request, const scene::Scene& scene,
                                             bool has_light) {
  if (!request.needs_network() || !has_light) return std::nullopt;
  runtime::Network network(checkpoint_or_shipped(request.checkpoint),
                           network_options(request.tool));
  network.check_fits(max_component(scene::point_bounds(scene).extent()), request.embedding.rescale);
  return network;
}

}  // namespace

void add_probe_options(CLI::App& app, ProbeRequest* r) {
  app.add_option("scene", r->scene, "Scene: .gltf, .glb, .pbrt, .obj or .ply")->required();
  app.add_option("--points", r->points,
                 "CSV file with the header px,py,pz,nx,ny,nz, world space, on surfaces");
  app.add_option("--out", r->out, "CSV file to write");
  app.add_option("--integrator", r->integrator,
                 "How light is computed. gather: rays from the points read path-traced light in an "
                 "irradiance cache on surfaces, the least error for its time from about a thousand "
                 "points on; network: the same rays read light that the network knows there; path: "
                 "path tracing alone, without bias")
      ->check(CLI::IsMember({"gather", "network", "path"}))
      ->capture_default_str();
  app.add_option("--spp", r->spp,
                 "Rays a point, and as many samples of direct light, or paths: by default 256, of "
                 "path 1024, or with --error their cap, 65536")
      ->check(CLI::Range(int64_t{1}, int64_t{1} << 20));
  app.add_option("--error", r->error,
                 "With --integrator path: relative standard error of total irradiance to reach, "
                 "e.g. 0.01")
      ->check(positive_number());
  app.add_option("--checkpoint", r->checkpoint,
                 "Model, with --integrator network; by default lte-hybrid");
  add_embedding_flags(app, &r->embedding);
  app.add_option("--seed", r->seed, "Seed of all samples")->capture_default_str();
  r->flags = &app;
  r->keys.add("depth", &r->max_depth, 1, 1000, "surface hits of light's path after the point");
  r->keys.add("records", &r->records, 2, int64_t{1} << 22,
              "of gather and network: places that the irradiance cache knows");
  r->keys.add("check", &r->check,
              "of gather and network: hold the indirect light to account by a few thousand paths, "
              "and warn where it is off by more than they explain");
  add_scene_keys(&r->keys, r);
  add_embedding_keys(&r->keys, &r->embedding);
  add_network_keys(&r->keys, &r->tool);
  r->keys.add_to(&app);
  app.parse_complete_callback([r] { r->keys.read(); });
  app.add_flag("--validate-only", r->validate_only, "Check scene, points and flags, and stop");
  add_scene_options(app, r);
  add_plain_tool_options(app, &r->tool);
}

void run_probe(const ProbeRequest& request) {
  check_usage(request);
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  for (const std::string& path : {request.out, request.tool.common.json, request.embedding.save})
    check_writable(path);
  const Timer timer;
  scene::PointTable points;
  if (!request.points.empty()) points = scene::read_point_table(request.points);
  const scene::Scene scene = load_source(request);
  describe(scene, request.scene);
  if (!request.validate_only) log_info(request.points, ": ", who_answers(request));
  Renderer renderer(scene);
  if (!renderer.has_light())
    log_warning(request.scene,
                ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  pathtrace::warn_of_lost_light(request.scene, renderer.bvh());
  pathtrace::settle_points(renderer.bvh(), request.points, &points);
  const std::optional<runtime::Network> network =
      load_network(request, scene, renderer.has_light());
  files.check_what_was_read();
  EmbedSettings settings;
  if (network) settings = settings_for(request, *network, points, renderer);
  if (request.validate_only) {
    std::printf("%s: valid scene, %lld triangles, %zu light groups\n", request.scene.c_str(),
                static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
    return;
  }
  const ProbeAnswer answer =
      renderer.has_light()
          ? answer_points(request, network ? &*network : nullptr, settings, points, &renderer)
          : darkness(points);
  say(request, answer, points.size());
  write(request, points, answer, timer.seconds());
}

}  // namespace lte::infer
