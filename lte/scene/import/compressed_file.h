// A file's bytes: mapped where they lie, or inflated where the file is gzip.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "lte/base/file.h"

namespace lte::scene {

/// Told apart by the magic of gzip (RFC 1952), not by the name.
class CompressedFile {
 public:
  /// @param limit_bytes  of the inflated text: a few kilobytes of gzip may stand for gigabytes
  /// @throws lte::Error naming the file: missing, a directory, truncated or damaged gzip, over the
  /// limit.
  explicit CompressedFile(const std::filesystem::path& path, size_t limit_bytes = size_t{1} << 32);

  std::string_view text() const { return text_; }

 private:
  std::unique_ptr<MappedFile> map_;
  std::string inflated_;
  std::string_view text_;
};

}  // namespace lte::scene
