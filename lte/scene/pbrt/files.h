// The files of one import: where relative names lead, and what was read so far.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "lte/scene/import/limits.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

class Files {
 public:
  /// @param scene  the file that the import starts with
  Files(const std::filesystem::path& scene, const LoadLimits& limits)
      : folder_(scene.parent_path()), limits_(limits) {}

  /// Finds the file that a directive at `at` names: relative to the file that the directive stands
  /// in, or, where nothing is there, to the scene's file, as pbrt itself does.
  /// @throws lte::Error if neither exists or it is not a regular file.
  std::filesystem::path find(const std::string& name, const Location& at) const;

  /// Opens one more text file for parsing, until close().
  /// @param at  place of the directive that names it; without a file for the scene itself
  /// @return    its interned name
  /// @throws lte::Error for a file that is being read already, too many files or too deep a
  /// nesting.
  const std::string* open(const std::filesystem::path& path, const Location& at);
  void close() { open_.pop_back(); }

  /// Counts text that is about to be parsed.
  /// @throws lte::Error beyond LoadLimits::text_bytes.
  void count_text(size_t bytes, const Location& at);

 private:
  std::filesystem::path folder_;
  const LoadLimits& limits_;
  std::set<std::string> names_;
  std::vector<std::filesystem::path> open_;
  int64_t opened_ = 0, bytes_ = 0;
};

}  // namespace lte::scene::pbrt
