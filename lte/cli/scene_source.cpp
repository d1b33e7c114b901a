#include "lte/cli/scene_source.h"

#include <cstdio>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/pathtrace/placement/added_light.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/load_camera.h"
#include "lte/scene/up_axis.h"

namespace lte {
namespace {

std::vector<scene::Camera> cameras_of(const scene::Scene& scene, const std::string& word) {
  if (!word.empty()) {
    const auto choice = scene::find_cameras(scene, word);
    return choice ? choice->cameras : std::vector<scene::Camera>();
  }
  if (scene.cameras.empty()) return {};
  return {scene.cameras.front()};
}

}  // namespace

void add_scene_options(CLI::App& app, SceneSource* source) {
  app.add_option("--up", source->up, scene::kUpHelp)
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  app.add_option("--environment", source->environment,
                 "Light from all around, in the place of the scene's own: constant radiance R,G,B, "
                 "or an equirectangular picture (.exr, .hdr, .pfm; .png, .jpg), Y up, +X in its "
                 "middle");
  app.add_option("--add-light", source->lights,
                 "A luminaire more: x,y,z,power, a point light of so many watts; or auto, a panel "
                 "under the ceiling of each room, or an environment for what is seen from outside. "
                 "Repeatable")
      ->type_name("auto|x,y,z,W")
      ->allow_extra_args(false);
  add_scene_flags(app, &source->loading);
}

void claim_scene(const SceneSource& source, CommandFiles* files) {
  files->reads("SCENE", source.scene);
  files->reads("--environment", source.environment);  // radiance R,G,B is the name of no file
}

scene::Scene load_source(const SceneSource& source, const std::string& camera) {
  scene::Scene scene = load_scene(source.scene, source.loading);
  scene::set_up_axis(source.up, source.scene, &scene);
  LTE_CHECK(!source.environment.empty() || source.environment_turn == 0,
            "--set environment_turn needs --environment");
  if (!source.environment.empty())
    scene::set_environment(source.environment, source.environment_turn, &scene);
  for (const std::string& light : source.lights)
    log_info(source.scene, ": added ", add_light(light, camera, &scene));
  return scene;
}

std::string add_light(const std::string& light, const std::string& camera, scene::Scene* scene) {
  std::vector<scene::Camera> cameras;
  if (light == "auto") cameras = cameras_of(*scene, camera);
  return pathtrace::add_light(light, cameras, scene);
}

void describe(const scene::Scene& scene, const std::string& path) {
  const Vec3 extent = scene.bounds().extent();
  log_info(path, ": ", scene.triangle_count(), " triangles, ", scene.instances.size(),
           " instances, ", scene.light_groups.size(), " lights, ", scene.cameras.size(),
           " cameras, ", extent.x, " x ", extent.y, " x ", extent.z, " m");
  for (const std::string& ignored : scene.ignored) log_warning(path, ": ignored ", ignored);
}

void print_valid_scene(const scene::Scene& scene, const std::string& path) {
  std::printf("%s: valid scene, %lld triangles, %zu light groups\n", path.c_str(),
              static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
}

}  // namespace lte
