// What commands that measure do before and after their work.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "lte/cli/cli.h"
#include "lte/cli/command_files.h"

namespace lte::bench {

/// Checks that the files of a command are no others of it and can be written, and applies the
/// common options, the threads of LibTorch among them.
/// @param files  inputs of the command
/// @param out    its page; empty: none
void begin_command(const CommonOptions& common, CommandFiles* files, const std::string& out = "");

/// A whole command: begin_command(), the measured rows as a table on standard output, and --json.
void run_measured(const CommonOptions& common, CommandFiles* files,
                  const std::function<std::vector<BenchResult>()>& measure);

}  // namespace lte::bench
