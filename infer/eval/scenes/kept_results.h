// Results of a report folder: a file of figures and a picture for each scene and method, which a
// later run takes where nothing that decides them has changed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "infer/eval/scenes/scenes.h"

namespace lte::infer {

class KeptResults {
 public:
  /// @param folder  of the report; empty: nothing is kept
  explicit KeptResults(const std::filesystem::path& folder);

  /// @param name  of scene and method; @param key  what decides the result
  /// @return nothing for a result that is not there, has another key or cannot be read
  std::optional<MethodOutcome> find(const std::string& name, const std::string& key) const;
  void keep(const std::string& name, const std::string& key, const MethodOutcome& outcome) const;

  /// The picture of a scene's reference.
  std::string find_picture(const std::string& name) const;
  void keep_picture(const std::string& name, const std::string& png) const;

 private:
  std::filesystem::path path(const std::string& name, const char* suffix) const;

  std::filesystem::path folder_;
};

/// Names of files within a report folder, for command_files.h.
inline constexpr const char* kResultsFolder = "results";
inline constexpr const char* kReferencesFolder = "references";
inline constexpr const char* kScenesPage = "report.html";

}  // namespace lte::infer
