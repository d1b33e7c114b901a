// The options of lte_export, and what it does with them.
#pragma once

#include <string>

#include "infer/export/export.h"
#include "lte/cli/cli.h"

namespace lte::infer {

/// Adds --checkpoint, --out, --portable, --verify and --bf16.
void add_export_options(CLI::App& app, ExportOptions* options);

/// Writes the module or, with options.bf16, the model file.
/// @return lines for the user
/// @throws lte::Error as export_torchscript() and export_rounded()
std::string run_export(const ExportOptions& options);

}  // namespace lte::infer
