#include "datagen/commands/info_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "datagen/commands/info.h"
#include "lte/base/check.h"
#include "lte/cli/cli.h"
#include "lte/data/dataset.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/free_space.h"
#include "lte/pathtrace/reach/lost_light.h"

namespace lte::datagen {
namespace {

struct InfoFlags {
  CommonOptions common;
  SceneSource source;  ///< its scene may be a sample file or a data set, too
  bool deep = false, validate_only = false;
};

/// The facts of a scene, with its unit where the height of its rooms gives that away.
Json describe_scene(const std::string& path, const scene::Scene& scene) {
  Json info = scene_info(scene);
  const pathtrace::Bvh bvh(scene);
  pathtrace::warn_of_lost_light(path, bvh);
  const char* unit = pathtrace::likely_unit(pathtrace::survey(bvh).room_height);
  if (unit != nullptr) info["likely_unit"] = unit;
  return info;
}

}  // namespace

Json describe(const SceneSource& source, bool deep) {
  const std::filesystem::path path = source.scene;
  const bool is_scene = !std::filesystem::is_directory(path) && path.extension() != ".safetensors";
  LTE_CHECK(std::filesystem::exists(path), source.scene, ": no such file or directory");
  LTE_CHECK(is_scene || source.environment.empty(), source.scene,
            ": --environment is for scenes, not for what is baked already");
  LTE_CHECK(is_scene || source.lights.empty(), source.scene,
            ": --add-light is for scenes, not for what is baked already");
  if (std::filesystem::is_directory(path)) return dataset_info(path, deep);
  if (!is_scene) return sample_info(data::read_scene_sample(path));
  return describe_scene(source.scene, load_lit(source));
}

namespace {

void run_info(const InfoFlags& flags) {
  CommandFiles files;
  claim_scene(flags.source, &files);
  files.reads_parts("PATH", flags.source.scene, data::kDatasetParts);
  files.writes_common(flags.common);
  files.check();
  apply_common_options(flags.common);
  const Json info = describe(flags.source, flags.deep || flags.validate_only);
  files.check_what_was_read();
  write_json(flags.common.json, info.dump(2));
  if (flags.validate_only) {
    std::printf("%s: valid %s\n", flags.source.scene.c_str(),
                info["kind"].get<std::string>().c_str());
  } else {
    std::fputs(to_yaml(info).c_str(), stdout);
  }
}

}  // namespace

void add_info_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<InfoFlags>();
  CLI::App* command =
      app.add_subcommand("info", "Say what a scene, a sample file or a data set holds");
  command
      ->add_option(
          "path", flags->source.scene,
          concat("Scene (", kSceneFormats, "), sample file (.safetensors) or data-set directory"))
      ->required();
  add_source_options(*command, &flags->source);
  command->add_flag("--deep", flags->deep, "Of a data set, read and check every sample file");
  command->add_flag("--validate-only", flags->validate_only, "Check everything and print one line");
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen info room.glb\n"
      "  lte_datagen info room.obj\n"
      "  lte_datagen info house.glb --environment sky.exr\n"
      "  lte_datagen info homes/scenes/home_00000.safetensors --json info.json\n"
      "  lte_datagen info homes --deep");
  command->callback([=] { *body = [flags] { run_info(*flags); }; });
}

}  // namespace lte::datagen
