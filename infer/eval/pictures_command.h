// lte_eval pictures: error of pictures against a reference, from files.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lte/cli/cli.h"

namespace lte::infer {

struct PicturesRequest {
  std::vector<std::string> pictures;  ///< .exr
  /// .exr of the same size: one, or two whose noise is independent.
  std::vector<std::string> references;
  std::string layer;  ///< empty: the picture itself
};

/// Adds the subcommand; it has been chosen if app.got_subcommand() says so.
CLI::App* add_pictures_command(CLI::App& app, PicturesRequest* request);

/// Reads the pictures, prints a line for each, and writes --json.
/// @throws lte::Error for files that are no pictures, and sizes that differ
void run_pictures(const PicturesRequest& request, const CommonOptions& common);

}  // namespace lte::infer
