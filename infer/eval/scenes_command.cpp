#include "infer/eval/scenes_command.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <tuple>

#include "infer/eval/eval_command.h"
#include "infer/eval/scenes/kept_results.h"
#include "infer/tool/picture_size.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/cli/assets.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;

/// SSIM's window.
constexpr int kMinSide = 11;

std::vector<std::string> words_of(const ScenesRequest& request) {
  if (!request.methods.empty()) return request.methods;
  return CLI::detail::split(kDefaultSceneMethods, ',');
}

std::vector<fs::path> checkpoints_of(const ScenesRequest& request) {
  std::vector<fs::path> out(request.checkpoints.begin(), request.checkpoints.end());
  if (!out.empty() || !asks_models(words_of(request))) return out;
  out.push_back(asset_path(kDefaultModel, "--checkpoint"));
  return out;
}

/// Flags of data sets say nothing about scenes.
void check_other_flags(const CLI::App& command) {
  const std::array<const char*, 7> shared = {"--help", "--threads",   "--quiet",     "--log-file",
                                             "--json", "--precision", "--max-memory"};
  for (const CLI::Option* option : command.get_parent()->get_options()) {
    const bool known = option->check_name("--device") ||
                       std::any_of(shared.begin(), shared.end(),
                                   [&](const char* name) { return option->check_name(name); });
    if (option->count() > 0 && !known)
      throw CLI::ValidationError(option->get_name(),
                                 "is of data sets; flags of scenes stand after the word scenes");
  }
}

std::vector<SceneModel> load_models(const std::vector<fs::path>& files, const ToolOptions& tool) {
  const runtime::NetworkOptions options = network_options(tool);
  std::vector<SceneModel> out;
  for (const fs::path& file : files) {
    std::string name = file.stem().string();
    const bool taken = std::any_of(out.begin(), out.end(),
                                   [&](const SceneModel& model) { return model.name == name; });
    if (taken) name = file.string();
    out.push_back({name, file.string(), runtime::Network(file, options)});
  }
  return out;
}

void claim_scene_files(const ScenesRequest& request, const scene::FoundScenes& scenes,
                       const std::vector<fs::path>& checkpoints, const ToolOptions& tool,
                       CommandFiles* files) {
  for (const scene::FoundScene& scene : scenes.scenes) {
    files->reads("SCENES", scene.path);
    files->reads("SCENES", scene.camera);
  }
  for (const fs::path& checkpoint : checkpoints) files->reads("--checkpoint", checkpoint);
  if (!request.report.empty())
    files->writes_parts("--report", request.report, {kScenesPage, kResultsFolder});
  files->writes_common(tool.common);
  files->check();
}

}  // namespace

CLI::App* add_scenes_command(CLI::App& app, ScenesRequest* r) {
  CLI::App* command = app.add_subcommand(
      "scenes", "Pictures of anybody's scenes, by models and by paths, against path tracing");
  r->command = command;
  command->fallthrough();
  command
      ->add_option("scenes", r->places,
                   "Folders, searched with their folders, and files: .glb, .gltf, .pbrt, .obj, "
                   ".ply; NAME.camera.json beside a scene is its camera, else its first one, else "
                   "an automatic one")
      ->required()
      ->type_name("FOLDER|FILE");
  command
      ->add_option(
          "--methods", r->methods,
          concat("Any of network (rays gather its light) and gather, as --quality preview or with "
                 "-draft or -final behind them; decoded (the network at every pixel without rays, "
                 "as programs without a BVH get it from the C interface); paths-N, "
                 "paths-N-denoised; default: ",
                 kDefaultSceneMethods))
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--checkpoint", r->checkpoints, "A model, repeatable; by default lte")
      ->allow_extra_args(false);
  command->add_option("--size", r->size, "Picture size")
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  command
      ->add_option("--reference-spp", r->options.reference_paths,
                   "Paths a pixel of each of both references")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command->add_option("--seed", r->options.seed, "Seed of every method and of the references")
      ->capture_default_str();
  command->add_option("--report", r->report,
                      "Folder for report.html, pictures and the results of each scene and method");
  command->add_option("--references", r->references,
                      "Folder in which references are kept from run to run; by default "
                      "references in that of --report, without which none are kept");
  command->add_flag("--resume", r->options.resume,
                    "Take results that the report folder has of the same scenes, models, settings "
                    "and program");
  add_scene_flags(*command, &r->options.loading);
  command->footer(
      "Examples:\n"
      "  lte_eval scenes assets/scenes --report out/scenes --json scenes.json\n"
      "  lte_eval scenes room.glb --methods network,paths-64 --checkpoint run/model.safetensors\n"
      "  lte_eval scenes assets/scenes --report out/scenes --resume");
  return command;
}

void run_scenes(const ScenesRequest& request, const ToolOptions& tool) {
  check_other_flags(*request.command);
  if (request.options.resume && request.report.empty())
    throw CLI::ValidationError("--resume", "needs the --report folder of the run before");
  apply_tool_options(tool);
  ScenesOptions options = request.options;
  std::tie(options.width, options.height) = parse_picture_size(request.size);
  LTE_CHECK(options.width >= kMinSide && options.height >= kMinSide, "--size ", request.size,
            ": SSIM needs ", kMinSide, " pixels a side or more");
  scene_methods(words_of(request), {});
  const scene::FoundScenes scenes = scene::find_scenes(request.places);
  const std::vector<fs::path> checkpoints = checkpoints_of(request);
  CommandFiles files;
  claim_scene_files(request, scenes, checkpoints, tool, &files);
  check_writable(tool.common.json);
  options.report = request.report;
  options.references = request.references;
  if (options.references.empty() && !options.report.empty())
    options.references = options.report / kReferencesFolder;
  options.memory = runtime::MemoryLimit(tool.max_memory_mb);
  const std::vector<SceneModel> models = load_models(checkpoints, tool);
  make_report_folder(request.report, kScenesPage);
  const ScenesResult result = evaluate_scenes(scenes, models, words_of(request), options);
  files.check_what_was_read();
  if (!options.report.empty()) {
    write_file(options.report / kScenesPage, scenes_html(result, options));
    log_info((options.report / kScenesPage).string());
  }
  if (!tool.common.json.empty()) write_file(tool.common.json, scenes_json(result, options));
  std::cout << scenes_table(result);
}

}  // namespace lte::infer
