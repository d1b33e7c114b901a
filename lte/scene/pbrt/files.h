// The text files of one import: where relative names lead, and what was read so far.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lte/scene/import/scene_files.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

class Files {
 public:
  explicit Files(SceneFiles* scene) : scene_(scene) {}

  /// Opens the file that a directive at `at` names: relative to the file that the directive stands
  /// in, or, where nothing is there, to the scene's file, as pbrt itself does.
  /// @throws lte::Error if neither exists or it is not a regular file; OutsideFolder for one that
  /// may not be read.
  SceneFilePtr find(const std::string& name, const Location& at) const;

  /// Begins the parsing of one more text file, until close().
  /// @param at  place of the directive that names it; without a file for the scene itself
  /// @return    its interned name
  /// @throws lte::Error for a file that is being read already, too many files or too deep a
  /// nesting.
  const TextFile* open(const SceneFile& file, const Location& at);
  void close() { open_.pop_back(); }

  /// Counts text that is about to be parsed.
  /// @throws OverLimit beyond LoadLimits::text_bytes.
  void count_text(size_t bytes, const Location& at);

  SceneFilePtr open_scene() const { return scene_->open_scene(); }
  LoadBudget& budget() const { return scene_->budget(); }
  const LoadLimits& limits() const { return scene_->limits(); }

 private:
  SceneFiles* scene_;
  std::map<std::string, TextFile> names_;
  std::vector<std::pair<uint64_t, uint64_t>> open_;
  int64_t opened_ = 0, bytes_ = 0;
};

}  // namespace lte::scene::pbrt
