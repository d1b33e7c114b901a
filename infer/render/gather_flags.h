// --indirect, which alone says how indirect light is made, and the flags of gathered light.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/light/light_table.h"
#include "infer/picture/output.h"
#include "infer/renderer/gathered_light.h"

namespace lte::infer {

/// The words of --indirect. Two of them gather light by rays from the pixels, of a table that
/// differs in where its light comes from.
enum class IndirectMethod { Gather, Network, Decoded, Paths };
constexpr EnumNames<IndirectMethod, 4> enum_names(IndirectMethod) {
  return {{{IndirectMethod::Gather, "gather"},
           {IndirectMethod::Network, "network"},
           {IndirectMethod::Decoded, "decoded"},
           {IndirectMethod::Paths, "paths"}}};
}

struct GatherFlags {
  std::string method = "gather";  ///< a word of IndirectMethod
  int64_t table_points = TableSettings().entries;
  int rays = 0, paths = -1;       ///< --gather-rays, --correction-paths; these: as the quality has
  std::string keep_light = "on";  ///< of several views
};

void add_gather_options(CLI::App& app, GatherFlags* flags);

IndirectMethod indirect_method(const GatherFlags& flags);
Indirect indirect_of(const GatherFlags& flags);
inline bool uses_network(IndirectMethod method) {
  return method == IndirectMethod::Network || method == IndirectMethod::Decoded;
}

/// @param neural     the mode; a reference uses none of these flags
/// @param attention  whether the picture is of the network itself
/// @throws lte::Error of one line for flags that the method does not use
void check_gather_flags(const CLI::App& app, const GatherFlags& flags, bool neural, bool attention);

/// @param max_depth  of the picture
TableSettings table_settings(const GatherFlags& flags, int max_depth, uint64_t seed);

}  // namespace lte::infer
