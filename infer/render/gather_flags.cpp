#include "infer/render/gather_flags.h"

#include <array>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

constexpr std::array<const char*, 6> kNetworkFlags = {
    "--checkpoint", "--embedding", "--save-embedding", "--scene-points", "--prune", "--draws"};
constexpr std::array<const char*, 3> kTableFlags = {"--gather-rays", "--table-points",
                                                    "--keep-light"};

/// The first of the flags that stands on the command line; null if none does.
template <size_t N>
const char* first_given(const CLI::App& app, const std::array<const char*, N>& flags) {
  for (const char* name : flags) {
    const CLI::Option* flag = app.get_option_no_throw(name);
    if (flag != nullptr && flag->count() > 0) return name;
  }
  return nullptr;
}

}  // namespace

void add_gather_options(CLI::App& app, GatherFlags* flags) {
  app.add_option("--indirect", flags->method,
                 "Neural mode, how indirect light is made. gather: rays from the pixels read light "
                 "path-traced at places of the scene, the least error for its time in rooms of any "
                 "kind; network: the same rays read the network's light there; decoded: the "
                 "network answers at each pixel; paths: --spp of them a pixel")
      ->check(CLI::IsMember({"gather", "network", "decoded", "paths"}))
      ->capture_default_str();
  app.add_option("--gather-rays", flags->rays,
                 "Of --indirect gather and network: rays a pixel; 0 for those of the quality")
      ->check(CLI::Range(0, 1 << 14))
      ->capture_default_str();
  app.add_option("--correction-paths", flags->paths,
                 "Paths a pixel that correct gathered light or, in a full picture, what the "
                 "network decodes: an even number or 0; -1 for those of the quality, which are "
                 "of gathered light alone")
      ->check(CLI::Range(-1, 1 << 20))
      ->capture_default_str();
  app.add_option("--table-points", flags->table_points,
                 "Of --indirect gather and network: places that the table knows, both sides "
                 "counted")
      ->check(CLI::Range(int64_t{2}, int64_t{1} << 22))
      ->capture_default_str();
  app.add_option("--keep-light", flags->keep_light,
                 "Of gathered light with draft or preview quality and several pictures: take "
                 "the light of earlier pictures where they show the same surfaces")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
}

IndirectMethod indirect_method(const GatherFlags& flags) {
  return parse_enum<IndirectMethod>("--indirect", flags.method);
}

Indirect indirect_of(const GatherFlags& flags) {
  switch (indirect_method(flags)) {
    case IndirectMethod::Decoded:
      return Indirect::Decoded;
    case IndirectMethod::Paths:
      return Indirect::Paths;
    default:
      return Indirect::Gather;
  }
}

void check_gather_flags(const CLI::App& app, const GatherFlags& flags, bool neural,
                        bool attention) {
  const IndirectMethod method = indirect_method(flags);
  const bool gathers = indirect_of(flags) == Indirect::Gather;
  const char* const table = first_given(app, kTableFlags);
  const char* const network = first_given(app, kNetworkFlags);
  if (!neural) {
    const char* const flag = table != nullptr ? table : first_given(app, std::array{"--indirect"});
    LTE_CHECK(flag == nullptr && flags.paths < 0, flag != nullptr ? flag : "--correction-paths",
              " needs --mode neural: a reference takes --spp paths a pixel");
    return;
  }
  LTE_CHECK(table == nullptr || gathers, table, " goes with --indirect gather or network, not ",
            flags.method);
  LTE_CHECK(network == nullptr || uses_network(method) || attention, network,
            " goes with --indirect network or decoded: --indirect ", flags.method,
            " needs no model");
  LTE_CHECK(flags.paths <= 0 || method != IndirectMethod::Paths,
            "--correction-paths goes with --indirect gather, network or decoded, not paths");
  LTE_CHECK(flags.paths <= 0 || flags.paths % 2 == 0, "--correction-paths ", flags.paths,
            ": expected an even number, as two halves are compared");
}

TableSettings table_settings(const GatherFlags& flags, int max_depth, uint64_t seed) {
  TableSettings out;
  out.light =
      indirect_method(flags) == IndirectMethod::Network ? TableLight::Network : TableLight::Raw;
  out.entries = flags.table_points;
  out.max_depth = max_depth;
  out.seed = seed;
  return out;
}

}  // namespace lte::infer
