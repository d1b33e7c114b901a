#include "infer/eval/scenes/kept_results.h"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "infer/eval/measure/reference_pair.h"
#include "infer/eval/scenes/figures_json.h"
#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;

std::string read_if_there(const fs::path& path) {
  return fs::exists(path) ? read_file(path) : std::string();
}

}  // namespace

KeptResults::KeptResults(const fs::path& folder) {
  if (folder.empty()) return;
  folder_ = folder / kResultsFolder;
  make_directory(folder_);
}

/// Names that differ in other letters than files may have differ in the checksum.
fs::path KeptResults::path(const std::string& name, const char* suffix) const {
  Checksum sum;
  sum.add(name);
  return folder_ /
         (file_words(name) +
          formatted("-%08llx", static_cast<unsigned long long>(sum.value() >> 32)) + suffix);
}

std::optional<MethodOutcome> KeptResults::find(const std::string& name,
                                               const std::string& key) const {
  if (folder_.empty() || !fs::exists(path(name, ".json"))) return std::nullopt;
  try {
    const nlohmann::json json = nlohmann::json::parse(read_file(path(name, ".json")));
    if (json.at("key") != key) return std::nullopt;
    MethodOutcome out;
    out.figures = figures_of(json.at("figures"));
    out.png = read_file(path(name, ".png"));
    return out;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void KeptResults::keep(const std::string& name, const std::string& key,
                       const MethodOutcome& outcome) const {
  if (folder_.empty()) return;
  write_file(path(name, ".png"), outcome.png);
  const nlohmann::json json{{"key", key}, {"figures", figures_json(outcome.figures)}};
  write_file(path(name, ".json"), json.dump(1) + "\n");
}

std::string KeptResults::find_picture(const std::string& name) const {
  return folder_.empty() ? std::string() : read_if_there(path(name, ".png"));
}

void KeptResults::keep_picture(const std::string& name, const std::string& png) const {
  if (!folder_.empty()) write_file(path(name, ".png"), png);
}

}  // namespace lte::infer
