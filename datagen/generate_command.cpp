#include <charconv>
#include <cstdio>
#include <memory>

#include "datagen/commands.h"
#include "datagen/generate.h"
#include "datagen/info.h"
#include "lte/base/check.h"
#include "lte/base/cli.h"
#include "lte/base/log.h"

namespace lte::datagen {
namespace {

struct Flags {
  CommonOptions common;
  GenerateOptions options;
  std::string config, out, shard;
  std::vector<std::string> overrides;
  int64_t scenes = 0;
  uint64_t seed = 0;
  bool has_scenes = false, has_seed = false, print_config = false;
};

/// "I/N".
void parse_shard(const std::string& text, GenerateOptions* options) {
  const char *begin = text.data(), *end = begin + text.size();
  const auto index = std::from_chars(begin, end, options->shard_index);
  const bool slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, options->shard_count) : index;
  LTE_CHECK(slash && count.ec == std::errc() && count.ptr == end && options->shard_index >= 0 &&
                options->shard_index < options->shard_count,
            "--shard: expected I/N with 0 <= I < N, got \"", text, "\"");
}

void run(Flags* flags) {
  apply_common_options(flags->common);
  DatagenConfig config = load_datagen_config(flags->config, flags->overrides);
  if (flags->has_scenes) config.scenes = flags->scenes;
  if (flags->has_seed) config.seed = flags->seed;
  check_datagen_config(config);
  if (flags->print_config) {
    std::fputs(to_yaml(config).c_str(), stdout);
    return;
  }
  LTE_CHECK(!flags->out.empty(), "--out is missing: name the directory of the data set");
  flags->options.out = flags->out;
  if (!flags->shard.empty()) parse_shard(flags->shard, &flags->options);
  const GenerateResult result = generate_dataset(config, flags->options);
  const double each = result.baked > 0 ? result.seconds / static_cast<double>(result.baked) : 0;
  log_info(flags->out, ": ", result.baked, " scenes baked (", each, " s each), ", result.kept,
           " kept, ", result.listed, " in dataset.json");
  write_json(flags->common.json, Json{{"baked", result.baked},
                                      {"kept", result.kept},
                                      {"listed", result.listed},
                                      {"seconds", result.seconds}}
                                     .dump());
}

}  // namespace

void add_generate_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand("generate", "Make a data set of procedural rooms");
  command->add_option("--config", flags->config, "YAML file; see configs/data/")->required();
  command->add_option("--out", flags->out,
                      "Directory of the data set: new, empty, or to be resumed");
  CLI::Option* scenes =
      command->add_option("--scenes", flags->scenes, "Number of scenes, instead of the config's");
  CLI::Option* seed =
      command->add_option("--seed", flags->seed, "Seed of the data set, instead of the config's");
  command->add_option("--set", flags->overrides, "Override a key of the config: key=value");
  command->add_option("--shard", flags->shard, "I/N: bake only the scenes with index % N == I");
  command->add_flag("--resume", flags->options.resume,
                    "Keep the valid scenes that are there and make the rest");
  command->add_flag("--glb", flags->options.glb, "Also write each scene as scenes/NAME.glb");
  command->add_flag("--print-config", flags->print_config,
                    "Print the whole configuration and stop");
  add_common_options(*command, &flags->common);
  command->footer(
      "Examples:\n"
      "  lte_datagen generate --config configs/data/rooms_small.yaml --out rooms\n"
      "  lte_datagen generate --config configs/data/rooms.yaml --out rooms --shard 0/4 --resume\n"
      "  lte_datagen generate --config configs/data/demo.yaml --out demo --scenes 8 --glb\n"
      "  lte_datagen generate --config configs/data/homes.yaml --out homes --scenes 8 --glb");
  command->callback([=] {
    flags->has_scenes = scenes->count() > 0;
    flags->has_seed = seed->count() > 0;
    *body = [flags] { run(flags.get()); };
  });
}

}  // namespace lte::datagen
