// A file that one process at a time holds and appends lines to.
#pragma once

#include <filesystem>
#include <string_view>

namespace lte {

/// The system drops the lock when the process ends, however it ends. The lock is one of flock(2).
/// Some network file systems lack it: then a warning is logged and nobody is refused.
class LockedFile {
 public:
  /// Makes the file if it is missing.
  /// @throws lte::Error if it cannot be opened for writing.
  explicit LockedFile(const std::filesystem::path& path);
  ~LockedFile();
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  /// True if another holder came first: this one may then read, and should not write.
  bool busy() const { return busy_; }

  /// Appends in one write and syncs, so that a kill cuts at most the last line short.
  /// @throws lte::Error naming the file.
  void append(std::string_view text);

 private:
  std::filesystem::path path_;
  int fd_;
  bool busy_ = false;
};

}  // namespace lte
