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

/// Adds --threads, --quiet, --log-file, --version, and --json unless `with_json` is false, as a
/// group of their own in the help.
void add_common_options(CLI::App& app, CommonOptions* options, bool with_json = true);

/// Applies threads, verbosity and log file.
void apply_common_options(const CommonOptions& options);

/// The value of every flag of `app`, given or not, one "name=value" a line: the TOML that CLI11
/// reads back. Values that the program has set since parsing are shown as they are now. For flags
/// bound to no variable, which CLI11 cannot ask, set a default_str().
std::string config_text(CLI::App& app);

/// Parses the command line and runs `body`. Installs the signal cleanup of file.h, and makes
/// threads of OpenMP wait without spinning (passive_waiting.h).
/// @return  0 on success, 2 on wrong usage, 1 where `body` throws; then with one line "tool: what
///          went wrong" on standard error
int run_tool(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

}  // namespace lte
