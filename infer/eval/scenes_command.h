// lte_eval scenes: the comparison of infer/eval/scenes/scenes.h on files.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "infer/eval/scenes/scenes.h"
#include "infer/tool/tool_options.h"

namespace lte::infer {

struct ScenesRequest {
  std::vector<std::string> places;       ///< files and folders
  std::vector<std::string> checkpoints;  ///< empty: the shipped model
  std::vector<std::string> methods;      ///< empty: kDefaultSceneMethods
  std::string size = "192x144";
  std::string report, references;
  ScenesOptions options;  ///< but for what stands above
  CLI::App* command = nullptr;
};

/// Adds the subcommand; it has been chosen if app.got_subcommand() says so.
CLI::App* add_scenes_command(CLI::App& app, ScenesRequest* request);

/// Measures, prints a table, and writes --json and the page of --report.
/// @throws lte::Error for bad input, CLI::ValidationError for flags of lte_eval's data sets
void run_scenes(const ScenesRequest& request, const ToolOptions& tool);

}  // namespace lte::infer
