#include <cstdio>
#include <filesystem>
#include <memory>

#include "datagen/commands/commands.h"
#include "datagen/commands/info.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/cli/cli.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/load.h"

namespace lte::datagen {
namespace {

void apply_environment(const SceneOptions& options, scene::Scene* scene) {
  LTE_CHECK(!options.environment.empty() || options.environment_turn == 0,
            "--environment-turn needs --environment");
  if (!options.environment.empty())
    scene::set_environment(options.environment, options.environment_turn, scene);
}

struct Flags {
  CommonOptions common;
  SceneOptions scene;
  std::string path;
  bool deep = false, validate_only = false;
};

Json describe(const Flags& flags) {
  const std::filesystem::path path = flags.path;
  const bool is_scene = !std::filesystem::is_directory(path) && path.extension() != ".safetensors";
  LTE_CHECK(std::filesystem::exists(path), flags.path, ": no such file or directory");
  LTE_CHECK(is_scene || flags.scene.environment.empty(), flags.path,
            ": --environment is for scenes, not for what is baked already");
  if (std::filesystem::is_directory(path))
    return dataset_info(path, flags.deep || flags.validate_only);
  if (!is_scene) return sample_info(data::read_scene_sample(path));
  scene::Scene scene = scene::load_scene(path);
  apply_environment(flags.scene, &scene);
  const scene::CleanupOptions cleanup = scene::parse_cleanup(flags.scene.cleanup);
  return cleanup.any() ? scene_info(scene, scene::clean_up(&scene, cleanup)) : scene_info(scene);
}

void run(const Flags& flags) {
  apply_common_options(flags.common);
  const Json info = describe(flags);
  write_json(flags.common.json, info.dump(2));
  if (flags.validate_only) {
    std::printf("%s: valid %s\n", flags.path.c_str(), info["kind"].get<std::string>().c_str());
  } else {
    std::fputs(to_text(info).c_str(), stdout);
  }
}

}  // namespace

void add_info_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command =
      app.add_subcommand("info", "Say what a scene, a sample file or a data set holds");
  command
      ->add_option(
          "path", flags->path,
          concat("Scene (", kSceneFormats, "), sample file (.safetensors) or data-set directory"))
      ->required();
  add_scene_options(*command, &flags->scene);
  command->add_flag("--deep", flags->deep, "Of a data set, read and check every sample file");
  command->add_flag("--validate-only", flags->validate_only, "Check everything and print one line");
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen info room.glb\n"
      "  lte_datagen info room.obj --cleanup degenerate,duplicates\n"
      "  lte_datagen info house.glb --environment sky.exr\n"
      "  lte_datagen info rooms/scenes/room_00000.safetensors --json info.json\n"
      "  lte_datagen info rooms --deep");
  command->callback([=] { *body = [flags] { run(*flags); }; });
}

void add_scene_options(CLI::App& app, SceneOptions* options) {
  app.add_option("--cleanup", options->cleanup,
                 "What of a scene's geometry to put right first: a list of degenerate, duplicates, "
                 "shells, vertices, meshes; or all; by default none");
  app.add_option("--environment", options->environment,
                 "Light from all around, in the place of the scene's own: constant radiance R,G,B, "
                 "or an equirectangular picture (.exr, .hdr, .pfm; .png, .jpg), Y up, +X in its "
                 "middle");
  app.add_option("--environment-turn", options->environment_turn,
                 "Degrees by which to turn it about +Y, counter-clockwise from above");
}

scene::Scene load_and_report(const std::string& path, const SceneOptions& flags) {
  const scene::CleanupOptions options = scene::parse_cleanup(flags.cleanup);
  scene::Scene scene = scene::load_scene(path);
  for (const std::string& what : scene.ignored) log_warning(path, ": ignored: ", what);
  apply_environment(flags, &scene);
  if (options.any()) {
    const scene::CleanupReport report = scene::clean_up(&scene, options);
    log_info(path, ": clean-up took ", report.removed_triangles, " triangles; found ",
             cleanup_info(report).dump());
  }
  return scene;
}

void print_validation(const std::string& path, const scene::Scene& scene) {
  std::printf("%s: valid scene, %lld triangles, %zu light groups\n", path.c_str(),
              static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
}

void write_json(const std::string& path, const std::string& text) {
  if (!path.empty()) write_file(path, text + "\n");
}

}  // namespace lte::datagen
