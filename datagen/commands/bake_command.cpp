#include "datagen/commands/bake_command.h"

#include <memory>
#include <optional>

#include "datagen/bake/bake.h"
#include "datagen/commands/info.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/cli/cli.h"
#include "lte/cli/writable.h"
#include "lte/scene/load_camera.h"

namespace lte::datagen {
namespace {

struct BakeFlags {
  CommonOptions common;
  SceneSource source;
  BakeOptions bake;
  std::string out, camera = "auto";
  bool has_views = false, validate_only = false;
};

/// Gives the views the cameras of --camera, and without --views one to each of them.
void set_cameras(const BakeFlags& flags, const scene::Scene& scene, BakeOptions* bake) {
  const std::optional<scene::CameraChoice> choice = scene::find_cameras(scene, flags.camera);
  LTE_CHECK(choice || flags.camera == "auto", "--camera ", flags.camera,
            ": the automatic cameras of bake follow from --seed; expected auto");
  if (!choice) return;
  bake->view_cameras = choice->cameras;
  if (!flags.has_views) bake->views.count = static_cast<int64_t>(choice->cameras.size());
}

void run_bake(BakeFlags flags) {
  CommandFiles files;
  claim_scene(flags.source, &files);
  files.reads("--camera", flags.camera);  // a name or a number is that of no file
  files.writes("--out", flags.out);
  files.writes_common(flags.common);
  files.check();
  apply_common_options(flags.common);
  check_bake_options(flags.bake);
  check_writable(flags.out);
  check_writable(flags.common.json);
  const scene::Scene scene = load_and_report(flags.source);
  set_cameras(flags, scene, &flags.bake);
  files.check_what_was_read();
  if (flags.validate_only) return print_valid_scene(scene, flags.source.scene);
  LTE_CHECK(!flags.out.empty(), "--out is missing: name the .safetensors file to write");
  const data::SceneSample sample = bake_scene(scene, flags.bake, true);
  data::write_scene_sample(flags.out, sample);
  log_info(flags.out, ": ", sample.scene_points(), " scene points, ", sample.query_points(),
           " query points, ", sample.light_groups, " light groups, ", sample.views.size(),
           " views, ", sample.incident.points(), " points with incident radiance; ",
           sample.pruned_scene_points, " and ", sample.pruned_query_points,
           " more points that light cannot reach were left out");
  write_json(flags.common.json, sample_info(sample).dump(2));
}

}  // namespace

void add_bake_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<BakeFlags>();
  BakeOptions& bake = flags->bake;
  CLI::App* command =
      app.add_subcommand("bake", "Sample and path-trace one scene into a sample file");
  command->add_option("scene", flags->source.scene, concat("Scene: ", kSceneFormats))->required();
  command->add_option("--out", flags->out, "Sample file to write, .safetensors");
  command->add_option("--scene-points", bake.scene_points, "M, points that describe the scene")
      ->capture_default_str();
  command->add_option("--queries", bake.query_points, "N, points with ground truth")
      ->capture_default_str();
  command->add_option("--rays", bake.rays, "Paths a query point")->capture_default_str();
  command
      ->add_option("--target-error", bake.target_error,
                   "Standard error of indirect irradiance, relative to its mean over the query "
                   "points, that decides how many paths each takes, e.g. 0.02; 0: --rays each")
      ->capture_default_str();
  command->add_option("--min-rays", bake.min_rays, "Paths a query point at least, with a target")
      ->capture_default_str();
  command->add_option("--max-rays", bake.max_rays, "Paths a query point at most, with a target")
      ->capture_default_str();
  command->add_option("--max-depth", bake.max_depth, "Surface hits of a path; 1 is direct light")
      ->capture_default_str();
  CLI::Option* views = command->add_option("--views", bake.views.count, "Number of views");
  views->capture_default_str();
  command
      ->add_option(
          "--camera", flags->camera,
          concat("Camera of the views: ", scene::kCameraHelp, "; views beyond them are automatic"))
      ->capture_default_str();
  command->add_option("--view-width", bake.views.width, "Pixels")->capture_default_str();
  command->add_option("--view-height", bake.views.height, "Pixels")->capture_default_str();
  command->add_option("--view-rays", bake.views.rays, "Paths a pixel of a view")
      ->capture_default_str();
  command
      ->add_option("--incident-points", bake.incident.points,
                   "Points with incident radiance by direction, for glossy surfaces; 0 for none")
      ->capture_default_str();
  command
      ->add_option("--incident-bins", bake.incident.bins,
                   "Directions are bins x bins cells of the hemisphere; even")
      ->capture_default_str();
  command->add_option("--incident-samples", bake.incident.samples, "Paths a cell")
      ->capture_default_str();
  command->add_option("--seed", bake.seed, "Seed of points and paths")->capture_default_str();
  add_source_options(*command, &flags->source);
  command->add_flag("--prune", bake.prune, "Draw points only where light can reach them");
  command->add_flag("--validate-only", flags->validate_only, "Check the scene and stop");
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen bake room.glb --out room.safetensors\n"
      "  lte_datagen bake room.glb --out room.safetensors --scene-points 4096 --queries 8192 "
      "--rays 256 --views 2\n"
      "  lte_datagen bake room.glb --out room.safetensors --target-error 0.02\n"
      "  lte_datagen bake home.glb --out home.safetensors --camera all\n"
      "  lte_datagen bake house.glb --out house.safetensors --environment sky.exr\n"
      "  lte_datagen bake room.glb --out room.safetensors --incident-points 256\n"
      "  lte_datagen bake room.glb --validate-only");
  command->callback([=] {
    flags->has_views = views->count() > 0;
    *body = [flags] { run_bake(*flags); };
  });
}

}  // namespace lte::datagen
