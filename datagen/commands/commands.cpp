#include "datagen/commands/commands.h"

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/pathtrace/placement/added_light.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/metal.h"
#include "lte/scene/up_axis.h"

namespace lte::datagen {

void add_scene_options(CLI::App& app, SceneOptions* options) {
  app.add_option("--environment", options->environment,
                 "Light from all around, in the place of the scene's own: constant radiance R,G,B, "
                 "or an equirectangular picture (.exr, .hdr, .pfm; .png, .jpg), Y up, +X in its "
                 "middle");
  app.add_option("--environment-turn", options->environment_turn,
                 "Degrees by which to turn it about +Y, counter-clockwise from above");
  add_scene_flags(app, &options->loading);
  app.add_option("--add-light", options->lights,
                 "A luminaire more: x,y,z,power, a point light of so many watts; or auto, a panel "
                 "under the ceiling of each room (an environment for a scene without any). "
                 "Repeatable")
      ->type_name("auto|x,y,z,W")
      ->allow_extra_args(false);
  app.add_option("--up", options->up, scene::kUpHelp)
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
}

void add_scene_files(const std::string& scene, const SceneOptions& options, CommandFiles* files) {
  files->reads("SCENE", scene);
  files->reads("--environment", options.environment);  // radiance R,G,B is the name of no file
}

void apply_lighting(const SceneOptions& options, scene::Scene* scene) {
  LTE_CHECK(!options.environment.empty() || options.environment_turn == 0,
            "--environment-turn needs --environment");
  if (!options.environment.empty())
    scene::set_environment(options.environment, options.environment_turn, scene);
  for (const std::string& light : options.lights)
    log_info("added ", pathtrace::add_light(light, scene));
}

scene::Scene load_and_report(const std::string& path, const SceneOptions& flags) {
  scene::Scene scene = load_scene(path, flags.loading);
  for (const std::string& what : scene.ignored) log_warning(path, ": ignored: ", what);
  scene::set_up_axis(flags.up, path, &scene);
  apply_lighting(flags, &scene);
  if (scene.light_groups.empty())
    log_warning(path,
                ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  else
    pathtrace::warn_of_lost_light(path, pathtrace::Bvh(scene));
  const std::string metal = scene::metal_text(scene::metal_share(scene), "surface");
  if (!metal.empty())
    log_info(path, ": ", metal, "; paths reflect it, a network is shown its color as an albedo");
  return scene;
}

std::string validation_line(const std::string& path, const scene::Scene& scene) {
  return concat(path, ": valid scene, ", scene.triangle_count(), " triangles, ",
                scene.light_groups.size(), " light groups\n");
}

void write_json(const std::string& path, const std::string& text) {
  if (!path.empty()) write_file(path, text + "\n");
}

}  // namespace lte::datagen
