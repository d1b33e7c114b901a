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

  /// Whether this object has made the file.
  bool made() const { return made_; }
  /// Removes the file from its folder; the lock holds until the end. Who waits for the file finds
  /// that it is gone and makes another.
  void remove();

  /// Appends in one write and syncs, so that a kill cuts at most the last line short.
  /// @throws lte::Error naming the file, DiskFull on a full disk.
  void append(std::string_view text);

 private:
  void open();
  bool is_in_place() const;

  std::filesystem::path path_;
  int fd_ = -1;
  bool busy_ = false, made_ = false;
};

}  // namespace lte
