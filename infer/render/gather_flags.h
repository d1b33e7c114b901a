// --indirect and the flags of gathered light.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/light/light_table.h"
#include "infer/picture/output.h"
#include "infer/renderer/gathered_light.h"

namespace lte::infer {

struct GatherFlags {
  std::string indirect = "auto";  ///< or a word of Indirect
  std::string table = "raw";      ///< a word of TableLight
  int64_t table_points = TableSettings().entries;
  int rays = 0, paths = -1;       ///< --gather-rays, --correction-paths; these: as the quality has
  std::string keep_light = "on";  ///< of several views
  Indirect by = Indirect::Network;  ///< found by resolve_indirect()
};

void add_gather_options(CLI::App& app, GatherFlags* flags);

/// Says who answers. Auto: gathered light where a flag of it alone is given; the network where a
/// flag of that is; else gathered light if a quality, a time or a correction was asked for, as the
/// chart of time against error says (docs/benchmarks.md), and the network without any. Puts the
/// word into `indirect`.
/// @param neural  the mode; a reference asks neither
void resolve_indirect(const CLI::App& app, bool neural, GatherFlags* flags);

/// @throws lte::Error of one line for flags of gathered light where none is gathered.
void check_gather_flags(const GatherFlags& flags, bool neural);

/// @param max_depth  of the picture
TableSettings table_settings(const GatherFlags& flags, int max_depth, uint64_t seed);

}  // namespace lte::infer
