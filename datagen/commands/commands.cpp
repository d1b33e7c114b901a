#include "datagen/commands/commands.h"

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/metal.h"

namespace lte::datagen {

void add_source_options(CLI::App& app, SceneSource* source) {
  add_scene_options(app, source);
  app.add_option("--environment-turn", source->environment_turn,
                 "Degrees by which to turn it about +Y, counter-clockwise from above");
}

scene::Scene load_lit(const SceneSource& source) {
  LTE_CHECK(!source.environment.empty() || source.environment_turn == 0,
            "--environment-turn needs --environment");
  return load_source(source);
}

scene::Scene load_and_report(const SceneSource& source) {
  const std::string& path = source.scene;
  scene::Scene scene = load_lit(source);
  for (const std::string& what : scene.ignored) log_warning(path, ": ignored: ", what);
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

void write_json(const std::string& path, const std::string& text) {
  if (!path.empty()) write_file(path, text + "\n");
}

}  // namespace lte::datagen
