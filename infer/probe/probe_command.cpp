#include "infer/probe/probe_command.h"

#include <array>
#include <cstdio>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/light/unreached_light.h"
#include "infer/light/untrained_light.h"
#include "infer/probe/probe_answers.h"
#include "infer/renderer/check_report.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"

namespace lte::infer {
namespace {

constexpr std::array kNetworkFlags = {"--checkpoint",   "--embedding", "--save-embedding",
                                      "--scene-points", "--prune",     "--draws"};

void check_usage(const ProbeRequest& request) {
  if (request.mode == "reference" && request.indirect_given && request.indirect != "paths")
    throw CLI::ValidationError("--indirect " + request.indirect, "goes with --mode neural only");
  if (!request.by_paths() && request.target_error > 0)
    throw CLI::ValidationError("--target-error",
                               "goes with --mode reference or --indirect paths only");
  if (!request.needs_network() && !request.network_flag.empty())
    throw CLI::ValidationError(request.network_flag,
                               "goes with --indirect network or decoded only");
  if (request.validate_only) return;
  if (request.points.empty())
    throw CLI::ValidationError("--points", "name a CSV file with the header px,py,pz,nx,ny,nz");
  if (request.out.empty()) throw CLI::ValidationError("--out", "name the CSV file to write");
}

/// What the network is told of the scene. Warns of light in it that the network does not know.
EmbedSettings told_of(const ProbeRequest& request, const runtime::Network& network,
                      const scene::PointTable& points, const Renderer& renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed,
                                          runtime::MemoryLimit(request.tool.max_memory_mb));
  leave_out_unreached(request.embedding, renderer.bvh(), network,
                      SurfacePlaces{points.position, points.normal}, &settings);
  const std::string note =
      untrained_light_note(renderer.bvh().scene(), network.metadata(), settings.unreached);
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
    log_warning(answer.light.missed, " of ", points, " points are above --target-error ",
                request.target_error, "; raise --rays above ", rays_of(request));
  if (answer.off_surface > 0)
    log_warning(request.points, ": ", answer.off_surface, " of ", points,
                " points lie on no surface; the network was trained on surfaces alone, so expect "
                "more error there");
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
                               {"mode", request.mode},
                               {"indirect", request.by_paths() ? "paths" : request.indirect},
                               {"points", points.size()},
                               {"off_surface", answer.off_surface},
                               {"above_target", answer.light.missed},
                               {"left_out_lights", answer.left_out},
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
  app.add_option("--mode", r->mode, "Fast answers, or the path-traced reference")
      ->check(CLI::IsMember({"neural", "reference"}))
      ->capture_default_str();
  app.add_option("--indirect", r->indirect,
                 "Neural mode: who answers for indirect light: rays from the points that read "
                 "path-traced light on surfaces (gather: the default, as it has the least error "
                 "in its time from about a thousand points on), the same over the network's light "
                 "(network), the network at the points themselves (decoded), or paths, as in "
                 "reference mode")
      ->check(CLI::IsMember({"gather", "network", "decoded", "paths"}))
      ->capture_default_str();
  app.add_option("--checkpoint", r->checkpoint, "Model; by default the shipped one");
  app.add_option("--rays", r->rays,
                 "Rays a point. Gather and network: 256 for indirect and as many for direct light; "
                 "decoded: 64 for direct light; paths: 1024, or with --target-error their cap, "
                 "65536")
      ->check(CLI::Range(int64_t{1}, int64_t{1} << 20));
  app.add_option("--max-depth", r->max_depth, "Surface hits of a path")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--target-error", r->target_error,
                 "Paths: relative standard error of total irradiance to reach, e.g. 0.01; "
                 "0: fixed --rays")
      ->check(non_negative_number());
  app.add_option("--check", r->check,
                 "Hold the indirect light to account by a few thousand paths, and warn where it is "
                 "off by more than they explain; paths need none")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  add_embedding_flags(app, &r->embedding, /*draws=*/2);
  app.add_option("--seed", r->seed, "Seed of scene points and paths")->capture_default_str();
  app.parse_complete_callback([&app, r] {
    r->indirect_given = app.count("--indirect") > 0;
    for (const char* name : kNetworkFlags) {
      const CLI::Option* flag = app.get_option_no_throw(name);
      if (flag != nullptr && flag->count() > 0) r->network_flag = name;
    }
  });
  app.add_flag("--validate-only", r->validate_only, "Check scene, points and flags, and stop");
  add_scene_options(app, r);
  add_tool_options(app, &r->tool);
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
  const std::optional<runtime::Network> network =
      load_network(request, scene, renderer.has_light());
  files.check_what_was_read();
  EmbedSettings settings;
  if (network) settings = told_of(request, *network, points, renderer);
  if (request.validate_only) {
    std::printf("%s: valid scene, %lld triangles, %zu light groups\n", request.scene.c_str(),
                static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
    return;
  }
  const ProbeAnswer answer =
      renderer.has_light()
          ? answer_points(request, network ? &*network : nullptr, settings, points, &renderer)
          : darkness(request, points);
  say(request, answer, points.size());
  write(request, points, answer, timer.seconds());
}

}  // namespace lte::infer
