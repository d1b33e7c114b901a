// The options of lte_export, and what it does with them.
#pragma once

#include <string>

#include "lte/cli/cli.h"

namespace lte::infer {

struct ExportRequest {
  CommonOptions common;
  std::string model;  ///< empty: the default one
  std::string out;
  bool portable = false, verify = false;
  bool bf16 = false;  ///< a model file in the place of a module
};

/// Adds the common options, --checkpoint, --out, --portable, --verify and --bf16.
void add_export_options(CLI::App& app, ExportRequest* request);

/// Writes the module or, with --bf16, the model file.
/// @return lines for the user
/// @throws lte::Error for two files that are one, a model file that is not called .safetensors, and
///         as lte::torchscript
std::string run_export(const ExportRequest& request);

}  // namespace lte::infer
