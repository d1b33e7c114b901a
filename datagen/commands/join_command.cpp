#include "datagen/commands/join_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "datagen/dataset/join.h"
#include "lte/cli/cli.h"

namespace lte::datagen {
namespace {

struct JoinFlags {
  CommonOptions common;
  std::vector<std::string> sets;
  std::string out;
};

int64_t count_of(const data::DatasetInfo& info, data::Split split) {
  return std::count_if(info.scenes.begin(), info.scenes.end(),
                       [&](const data::DatasetEntry& entry) { return entry.split == split; });
}

void run_join(const JoinFlags& flags) {
  CommandFiles files;
  for (const std::string& set : flags.sets) files.reads_parts("SET", set, data::kDatasetParts);
  files.writes_parts("--out", flags.out, data::kDatasetParts);
  files.writes_common(flags.common);
  files.check();
  apply_common_options(flags.common);
  const data::DatasetInfo info = join({flags.sets.begin(), flags.sets.end()}, flags.out);
  nlohmann::json json = {{"out", flags.out}, {"scenes", info.scenes.size()}};
  for (const data::Split split : {data::Split::Train, data::Split::Val, data::Split::Test})
    json[data::split_name(split)] = count_of(info, split);
  write_json(flags.common.json, json.dump(2));
  if (flags.common.quiet) return;
  std::printf(
      "%s: %zu scenes of %zu data sets: %lld to train on, %lld to validate on, %lld to test\n",
      flags.out.c_str(), info.scenes.size(), flags.sets.size(), json["train"].get<long long>(),
      json["val"].get<long long>(), json["test"].get<long long>());
}

}  // namespace

void add_join_command(CLI::App& app, CommandBody* body) {
  auto flags = std::make_shared<JoinFlags>();
  CLI::App* command = app.add_subcommand(
      "join", "Make one data set of several, which must be of one scale; files are linked");
  command->add_option("sets", flags->sets, "Data-set directories, two or more")->required();
  command->add_option("--out", flags->out, "Directory of the new data set")->required();
  add_common_options(*command, &flags->common);
  command->footer(
      "Example:\n"
      "  lte_datagen join data/boxes data/homes --out data/both");
  command->callback([=] { *body = [flags] { run_join(*flags); }; });
}

}  // namespace lte::datagen
