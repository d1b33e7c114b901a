#include "infer/probe/probe_command.h"

#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/check/check_report.h"
#include "infer/probe/probe_answers.h"
#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"
#include "lte/embed/culled_lights.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/lost_light.h"

namespace lte::infer {
namespace {

void check_usage(const ProbeRequest& r) {
  LTE_CHECK(r.error == 0 || r.by_paths(), "--error goes with --integrator path, not ",
            r.integrator);
  check_light_used(r, {"records", "check"});
  if (r.validate_only) return;
  LTE_CHECK(!r.points.empty(), "--points: name a CSV file with the header px,py,pz,nx,ny,nz");
  LTE_CHECK(!r.out.empty(), "--out: name the CSV file to write");
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
  claim_light_files(request, files);
  files->reads("--points", request.points);
  files->writes("--out", request.out);
  files->check();
}

}  // namespace

void add_probe_options(CLI::App& app, ProbeRequest* r) {
  app.add_option("scene", r->scene, "Scene: .gltf, .glb, .pbrt, .obj or .ply")->required();
  app.add_option("--points", r->points,
                 "CSV file with the header px,py,pz,nx,ny,nz, world space, on surfaces");
  app.add_option("--out", r->out, "CSV file to write");
  add_light_flags(app, "the points", r);
  app.add_option("--spp", r->spp,
                 "Rays a point, and as many samples of direct light, or paths: by default 256, of "
                 "path 1024, or with --error their cap, 65536")
      ->check(CLI::Range(int64_t{1}, int64_t{1} << 20));
  app.add_option("--error", r->error,
                 "With --integrator path: relative standard error of total irradiance to reach, "
                 "e.g. 0.01")
      ->check(positive_number());
  add_embedding_flags(app, &r->embedding);
  add_light_keys("the point", r);
  r->keys.add("check", &r->check,
              "of gather and network: hold the indirect light to account by a few thousand paths, "
              "and warn where it is off by more than they explain");
  app.add_flag("--validate-only", r->validate_only, "Check scene, points and flags, and stop");
  add_tool_flags(app, r);
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
  std::optional<runtime::Network> network;
  if (request.needs_network() && renderer.has_light()) network = load_network(request, scene);
  files.check_what_was_read();
  EmbedSettings settings;
  if (network) {
    settings = embed_settings(request, *network,
                              embed::SurfacePlaces{points.position, points.normal}, renderer);
  }
  if (request.validate_only) return print_valid_scene(scene, request.scene);
  const ProbeAnswer answer =
      renderer.has_light()
          ? answer_points(request, network ? &*network : nullptr, settings, points, &renderer)
          : darkness(points);
  say(request, answer, points.size());
  write(request, points, answer, timer.seconds());
}

}  // namespace lte::infer
