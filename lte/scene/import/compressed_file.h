// A file's text: as it lies there, or inflated where the file is gzip.
#pragma once

#include <string>
#include <string_view>

#include "lte/scene/import/scene_files.h"

namespace lte::scene {

/// Told apart by the magic of gzip (RFC 1952), not by the name.
class CompressedFile {
 public:
  /// @param budget  what the text may take: a few kilobytes of gzip may stand for gigabytes
  /// @throws lte::Error naming the file for truncated or damaged gzip, OverLimit for too long a
  /// text.
  CompressedFile(SceneFilePtr file, LoadBudget* budget);

  const SceneFile& file() const { return *file_; }
  std::string_view text() const { return text_; }

 private:
  SceneFilePtr file_;
  std::string inflated_;
  std::string_view text_;
};

}  // namespace lte::scene
