// A run as one page for people: curves, time, and the scenes that go worst.
#pragma once

#include <filesystem>
#include <string>

namespace lte::train {

/// Reads log.jsonl, config.yaml and previews/ of a run directory, finished or not, and writes a
/// self-contained HTML page.
/// @param out  empty: <run>/report.html
/// @return     a line for people
/// @throws lte::Error naming the file that is missing or cannot be written.
std::string write_run_report(const std::filesystem::path& run, std::filesystem::path out = {});

}  // namespace lte::train
