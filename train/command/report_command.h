// `lte_train report RUN`: a run as one page for people, with curves, times and the worst scenes.
#pragma once

#include <filesystem>
#include <string>

#include "lte/cli/cli.h"

namespace lte::train {

struct ReportOptions {
  std::string run;  ///< run directory
  std::string out;  ///< the page; empty: RUN/report.html
};

/// Adds the subcommand. @return it, to ask whether it was given
CLI::App* add_report_command(CLI::App& app, ReportOptions* options);

/// Reads log.jsonl, config.yaml and previews/ of a run directory, finished or not, and writes a
/// self-contained HTML page.
/// @param out  empty: <run>/report.html
/// @return     a line for people
/// @throws lte::Error naming the file that is missing or cannot be written.
std::string write_run_report(const std::filesystem::path& run, std::filesystem::path out = {});

}  // namespace lte::train
