#include "datagen/commands/probe_command.h"

#include <memory>

#include "datagen/commands/info.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/cli.h"
#include "lte/cli/progress.h"
#include "lte/cli/writable.h"
#include "lte/pathtrace/probe.h"

namespace lte::datagen {
namespace {

/// Cap on rays when --target-error decides how many a point needs and --rays is not given.
constexpr int64_t kDefaultCap = 65536;

struct ProbeFlags {
  CommonOptions common;
  SceneSource source;
  pathtrace::ProbeOptions probe;
  std::string points, out;
  bool has_rays = false, validate_only = false;
};

pathtrace::ProbeResult run(const scene::Scene& scene, const std::string& file,
                           scene::PointTable points, pathtrace::ProbeOptions options) {
  const bool by_paths = options.target_error > 0;
  Progress progress("probing", by_paths ? 0 : static_cast<int64_t>(points.size()),
                    by_paths ? "paths" : "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  settle_points(bvh, file, &points);
  return probe(bvh, lights, points, options);
}

void run_probe(ProbeFlags* flags) {
  CommandFiles files;
  claim_scene(flags->source, &files);
  files.reads("--points", flags->points);
  files.writes("--out", flags->out);
  files.writes_common(flags->common);
  files.check();
  apply_common_options(flags->common);
  check_writable(flags->out);
  check_writable(flags->common.json);
  const scene::Scene scene = load_and_report(flags->source);
  files.check_what_was_read();
  if (flags->validate_only) return print_valid_scene(scene, flags->source.scene);
  LTE_CHECK(!flags->points.empty(),
            "--points is missing: name a CSV file with the header px,py,pz,nx,ny,nz");
  LTE_CHECK(!flags->out.empty(), "--out is missing: name the CSV file to write");
  if (flags->probe.target_error > 0 && !flags->has_rays) flags->probe.rays = kDefaultCap;
  const scene::PointTable points = scene::read_point_table(flags->points);
  const Timer timer;
  const pathtrace::ProbeResult result = run(scene, flags->points, points, flags->probe);
  scene::write_point_table(flags->out, points, probe_columns(result));
  if (result.missed > 0) {
    log_warning(result.missed, " of ", points.lines.size(), " points are above --target-error ",
                flags->probe.target_error, "; raise --rays above ", flags->probe.rays);
  }
  log_info(flags->out, ": ", points.lines.size(), " points in ", timer.seconds(), " s");
  write_json(flags->common.json, Json{{"points", points.lines.size()},
                                      {"above_target", result.missed},
                                      {"seconds", timer.seconds()}}
                                     .dump());
}

}  // namespace

void add_probe_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<ProbeFlags>();
  CLI::App* command =
      app.add_subcommand("probe", "Path-trace irradiance at the points of a CSV file");
  command->add_option("scene", flags->source.scene, concat("Scene: ", kSceneFormats))->required();
  command->add_option("--points", flags->points,
                      "CSV file with the header px,py,pz,nx,ny,nz, world space");
  command->add_option("--out", flags->out, "CSV file to write");
  CLI::Option* rays =
      command->add_option("--rays", flags->probe.rays,
                          "Paths a point; with --target-error their cap (then 65536 by default)");
  rays->capture_default_str();
  command
      ->add_option("--max-depth", flags->probe.max_depth,
                   "Surface hits of a path; 1 is direct light")
      ->capture_default_str();
  command->add_option(
      "--target-error", flags->probe.target_error,
      "Relative standard error of total irradiance to reach, e.g. 0.01; 0: fixed --rays");
  command->add_option("--seed", flags->probe.seed, "Seed of the paths")->capture_default_str();
  add_source_options(*command, &flags->source);
  command->add_flag("--validate-only", flags->validate_only, "Check the scene and stop");
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen probe room.glb --points points.csv --out irradiance.csv --rays 4096\n"
      "  lte_datagen probe room.glb --points points.csv --out irradiance.csv --target-error 0.01\n"
      "  lte_datagen probe house.glb --points points.csv --out irradiance.csv --environment 1,1,1");
  command->callback([=] {
    flags->has_rays = rays->count() > 0;
    *body = [flags] { run_probe(flags.get()); };
  });
}

}  // namespace lte::datagen
