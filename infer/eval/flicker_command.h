// lte_eval flicker: the measure of infer/picture/flicker.h on files.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lte/cli/cli.h"

namespace lte::infer {

struct FlickerRequest {
  std::vector<std::string> frames, reference;  ///< .exr by lte_render, in the order of time
  std::string layer;                           ///< empty: the picture itself
};

/// Adds the subcommand; it has been chosen if app.got_subcommand() says so.
CLI::App* add_flicker_command(CLI::App& app, FlickerRequest* request);

/// Reads the frames, measures, prints a line, and writes --json.
/// @throws lte::Error for files that are no frames, and as measure_flicker()
void run_flicker(const FlickerRequest& request, const CommonOptions& common);

}  // namespace lte::infer
