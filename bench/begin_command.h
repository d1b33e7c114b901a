// What commands of lte_bench do before their work.
#pragma once

#include <string>

#include "lte/cli/cli.h"
#include "lte/cli/command_files.h"

namespace lte::bench {

/// Checks that the files of a command are no others of it and can be written, and applies the
/// common options, the threads of LibTorch among them.
/// @param files  inputs of the command
/// @param out    its page; empty: none
void begin_command(const CommonOptions& common, CommandFiles* files, const std::string& out = "");

}  // namespace lte::bench
