#include "infer/render/gather_flags.h"

#include <algorithm>
#include <array>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

constexpr std::array<const char*, 7> kNetworkFlags = {
    "--checkpoint",   "--edit",  "--embedding", "--save-embedding",
    "--scene-points", "--prune", "--draws"};

/// A flag of gathered light alone that says something; null if none does.
const char* gather_flag(const GatherFlags& flags) {
  if (flags.rays != 0) return "--gather-rays";
  if (flags.table != GatherFlags().table) return "--table";
  return flags.table_points != GatherFlags().table_points ? "--table-points" : nullptr;
}

}  // namespace

void add_gather_options(CLI::App& app, GatherFlags* flags) {
  app.add_option("--indirect", flags->indirect,
                 "Neural mode: who answers for indirect light: the network, rays that read a table "
                 "of the light on surfaces (gather), or paths (--spp a pixel); auto: gather with "
                 "--quality, --time-budget or a flag of it, else the network")
      ->check(CLI::IsMember({"auto", "network", "gather", "paths"}))
      ->capture_default_str();
  app.add_option("--gather-rays", flags->rays,
                 "Of --indirect gather: rays a pixel; 0 for those of the quality")
      ->check(CLI::Range(0, 1 << 14))
      ->capture_default_str();
  app.add_option("--correction-paths", flags->paths,
                 "Paths a pixel that correct gathered light or, in a full picture, what the "
                 "network answers: an even number or 0; -1 for those of the quality, which are "
                 "of gathered light alone")
      ->check(CLI::Range(-1, 1 << 20))
      ->capture_default_str();
  app.add_option("--table", flags->table,
                 "Of --indirect gather: what fills the table, path-traced estimates, which need no "
                 "model (raw), or the network")
      ->check(CLI::IsMember({"raw", "network"}))
      ->capture_default_str();
  app.add_option("--table-points", flags->table_points,
                 "Of --indirect gather: places that the table knows, both sides counted")
      ->check(CLI::Range(int64_t{2}, int64_t{1} << 22))
      ->capture_default_str();
  app.add_option("--keep-light", flags->keep_light,
                 "Of --indirect gather with draft or preview quality and several pictures: take "
                 "the light of earlier pictures where they show the same surfaces")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
}

void resolve_indirect(const CLI::App& app, bool neural, GatherFlags* flags) {
  const auto given = [&](const char* name) {
    const CLI::Option* flag = app.get_option_no_throw(name);
    return flag != nullptr && flag->count() > 0;
  };
  if (flags->indirect != "auto") {
    flags->by = parse_enum<Indirect>("--indirect", flags->indirect);
  } else if (gather_flag(*flags) != nullptr) {
    flags->by = Indirect::Gather;
  } else if (!neural || std::any_of(kNetworkFlags.begin(), kNetworkFlags.end(), given)) {
    flags->by = Indirect::Network;
  } else {
    const bool asks = given("--quality") || given("--time-budget") || flags->paths >= 0;
    flags->by = asks ? Indirect::Gather : Indirect::Network;
  }
  flags->indirect = enum_name(flags->by);
}

void check_gather_flags(const GatherFlags& flags, bool neural) {
  const char* flag = gather_flag(flags);
  LTE_CHECK(flag == nullptr || flags.by == Indirect::Gather, flag,
            " goes with --indirect gather, not with --indirect ", flags.indirect);
  LTE_CHECK(neural || (flags.by != Indirect::Gather && flags.paths < 0),
            flag != nullptr    ? flag
            : flags.paths >= 0 ? "--correction-paths"
                               : "--indirect gather",
            " needs --mode neural: a reference takes --spp paths a pixel");
  LTE_CHECK(flags.paths <= 0 || flags.by != Indirect::Paths,
            "--correction-paths goes with --indirect gather or network, not with --indirect paths");
  LTE_CHECK(flags.paths <= 0 || flags.paths % 2 == 0, "--correction-paths ", flags.paths,
            ": expected an even number, as two halves are compared");
}

TableSettings table_settings(const GatherFlags& flags, int max_depth, uint64_t seed) {
  TableSettings out;
  out.light = parse_enum<TableLight>("--table", flags.table);
  out.entries = flags.table_points;
  out.max_depth = max_depth;
  out.seed = seed;
  return out;
}

}  // namespace lte::infer
