// Reads log.jsonl back, as figures over steps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lte::train {

/// Step and value, in the order of the file.
using Series = std::vector<std::pair<double, double>>;

struct RunHistory {
  std::map<std::string, Series> figures;  ///< by their names in the log; without nulls
  std::map<std::string, Series> scenes;   ///< validation loss by scene
  int64_t last_step = 0;

  const Series& figure(const std::string& name) const;  ///< empty if the log has none
};

/// Lines that are no JSON objects with a step are left out: the last one may have been cut short.
/// @throws lte::Error naming the file if it cannot be read or no line tells anything.
RunHistory read_run_log(const std::filesystem::path& path);

}  // namespace lte::train
