#include "datagen/commands/generate_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "datagen/commands/info.h"
#include "datagen/dataset/generate.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/to_number.h"
#include "lte/cli/cli.h"
#include "lte/cli/scene_flags.h"

namespace lte::datagen {
namespace {

struct GenerateFlags {
  CommonOptions common;
  GenerateOptions options;
  std::string config, out, shard;
  std::vector<std::string> overrides;
  int64_t scenes = 0;
  uint64_t seed = 0;
  bool has_scenes = false, has_seed = false, print_config = false, merge = false;
};

/// Reads "I/N".
void parse_shard(const std::string& text, GenerateOptions* options) {
  const auto numbers = to_numbers<int64_t, 2>(text, '/');
  LTE_CHECK(numbers && (*numbers)[0] >= 0 && (*numbers)[0] < (*numbers)[1],
            "--shard: expected I/N with 0 <= I < N, got \"", text, "\"");
  options->shard = {(*numbers)[0], (*numbers)[1]};
}

void report(const GenerateFlags& flags, const GenerateResult& result) {
  const double each = result.baked > 0 ? result.seconds / static_cast<double>(result.baked) : 0;
  if (!flags.merge)
    log_info(flags.out, ": ", result.baked, " scenes baked (", each, " s each), ", result.kept,
             " kept, ", result.failed, " failed");
  if (result.listed > 0) {
    log_info(flags.out, ": ", result.listed, " of ", result.planned, " scenes in dataset.json");
  } else if (result.missing > 0) {
    log_info(flags.out, ": ", result.missing, " of ", result.planned,
             " scenes are still to be made; whoever makes the last one writes dataset.json");
  }
  write_json(flags.common.json, Json{{"baked", result.baked},
                                     {"kept", result.kept},
                                     {"failed", result.failed},
                                     {"planned", result.planned},
                                     {"missing", result.missing},
                                     {"listed", result.listed},
                                     {"seconds", result.seconds}}
                                    .dump());
}

void merge(const GenerateFlags& flags) {
  const GenerateResult result = merge_dataset(flags.out);
  if (result.missing + result.failed > 0)
    log_warning(flags.out, ": ", result.missing, " of ", result.planned, " scenes are missing, ",
                result.failed, " failed; generate --resume makes them");
  report(flags, result);
}

void run_generate(GenerateFlags* flags) {
  CommandFiles files;
  // A data set that goes on may do so with its own config.yaml.
  const bool own = flags->options.resume && !flags->config.empty() &&
                   std::filesystem::weakly_canonical(flags->config) ==
                       std::filesystem::weakly_canonical(config_path(flags->out));
  if (!own) files.reads("--config", flags->config);
  if (!flags->print_config) files.writes_parts("--out", flags->out, data::kDatasetParts);
  files.writes_common(flags->common);
  files.check();
  apply_common_options(flags->common);
  LTE_CHECK(!flags->out.empty() || flags->print_config,
            "--out is missing: name the directory of the data set");
  if (flags->merge) return merge(*flags);
  if (flags->config.empty()) flags->config = config_path(flags->out).string();
  DatagenConfig config = load_datagen_config(flags->config, flags->overrides);
  files.check_what_was_read();
  if (flags->has_scenes) config.scenes = flags->scenes;
  if (flags->has_seed) config.seed = flags->seed;
  check_datagen_config(config);
  const SceneFlags& loading = flags->options.loading;
  LTE_CHECK(config.generator == GeneratorKind::Files ||
                (!loading.allow_outside && loading.limits.empty()),
            loading.allow_outside ? "--allow-outside" : "--limits",
            " goes with generator: files; this one reads no scenes");
  if (flags->print_config) {
    std::fputs(to_yaml(config).c_str(), stdout);
    return;
  }
  flags->options.out = flags->out;
  if (!flags->shard.empty()) parse_shard(flags->shard, &flags->options);
  const SignalNote note(
      concat(flags->out, ": stopped; the finished scenes stay, go on with --resume"));
  const GenerateResult result = generate_dataset(config, flags->options);
  report(*flags, result);
  LTE_CHECK(result.failed == 0, flags->out, ": ", result.failed,
            " scenes failed, the first of them ", result.first_error,
            "; manifest/ names them all, and --resume tries them again");
}

}  // namespace

void add_generate_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<GenerateFlags>();
  CLI::App* command = app.add_subcommand(
      "generate", "Make a data set of procedural boxes, homes or wild rooms, or of scene files");
  CLI::Option* config = command->add_option(
      "--config", flags->config,
      "YAML file; see configs/data/. With --resume the data set's own unless given");
  command->add_option("--out", flags->out,
                      "Directory of the data set: new, empty, or to be resumed");
  CLI::Option* scenes =
      command->add_option("--scenes", flags->scenes, "Number of scenes, instead of the config's");
  CLI::Option* seed =
      command->add_option("--seed", flags->seed, "Seed of the data set, instead of the config's");
  command->add_option("--set", flags->overrides, "Override a key of the config: key=value");
  CLI::Option* shard = command->add_option(
      "--shard", flags->shard,
      "I/N, I from 0 to N - 1: bake only the scenes with index % N == I. Shards may run at once");
  CLI::Option* resume =
      command->add_flag("--resume", flags->options.resume,
                        "Keep the valid scenes that are there and make the rest; needed for a data "
                        "set that has scenes, allowed for a new one");
  command->add_flag("--strict", flags->options.strict,
                    "End at the first scene that fails. Else it is written down in manifest/, left "
                    "out, and the exit code is 1 at the end");
  CLI::Option* merge = command->add_flag(
      "--merge", flags->merge,
      "Bake nothing: write dataset.json of the scenes that are there, though some be missing");
  for (CLI::Option* other : {config, scenes, seed, shard, resume}) merge->excludes(other);
  command->add_flag("--glb", flags->options.glb,
                    "Also write each scene as scenes/NAME.glb, its sky as NAME.sky.exr");
  command->add_flag("--print-config", flags->print_config,
                    "Print the whole configuration and stop");
  add_scene_flags(*command, &flags->options.loading);
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen generate --config configs/data/demo.yaml --out demo --scenes 8 --glb\n"
      "  lte_datagen generate --config configs/data/homes.yaml --out homes --scenes 200\n"
      "  lte_datagen generate --config configs/data/homes.yaml --out homes --shard 0/4 --resume\n"
      "  lte_datagen generate --config configs/data/files.yaml --out rooms --scenes 20 \\\n"
      "      --set files.folder=rooms_of_mine\n"
      "  lte_datagen generate --out homes --resume\n"
      "  lte_datagen generate --out homes --merge\n"
      "docs/dataset.md has scripts for SLURM and for shells.");
  command->callback([=] {
    if (config->count() == 0 && !flags->merge && !flags->options.resume)
      throw CLI::RequiredError("--config");
    flags->has_scenes = scenes->count() > 0;
    flags->has_seed = seed->count() > 0;
    *body = [flags] { run_generate(flags.get()); };
  });
}

}  // namespace lte::datagen
