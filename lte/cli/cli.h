// What every tool's command line shares: the common flags, the version, and main's way of ending.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>

namespace lte {

/// The flags a tool shows beside its own.
struct CommonOptions {
  int threads = 0;  ///< 0: all
  bool quiet = false;
  std::string log_file;
  std::string json;  ///< where the machine-readable result goes; empty: nowhere
};

/// Adds --threads, --quiet, --log-file, --version, and --json unless `with_json` is false. Name the
/// group in the help.
void add_common_options(CLI::App& app, CommonOptions* options, bool with_json = true);

/// Applies threads, verbosity and log file.
void apply_common_options(const CommonOptions& options);

/// Parses and runs: 0 on success, 2 on wrong usage, 1 with one line "tool: what went wrong" on
/// standard error when `body` throws. Installs the signal cleanup of file.h.
int run_tool(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

}  // namespace lte
