// Who holds a run directory: one process at a time.
#pragma once

#include <filesystem>

#include "lte/base/locked_file.h"

namespace lte::train {

/// Two writers would mix two runs in one directory: a batch system that starts a job again while
/// the first still runs, say. The file is `.lock`.
class RunLock {
 public:
  /// Makes the directory if it is missing, takes it, and removes what killed processes have left.
  /// @throws lte::Error if it cannot be made, or if another process holds it.
  explicit RunLock(const std::filesystem::path& run);

  /// A start that ends before keep() leaves neither the file nor the directory, if it has made them
  /// and nothing else is in there.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  void keep() { kept_ = true; }

 private:
  static bool make(const std::filesystem::path& run);

  std::filesystem::path run_;
  bool made_run_;
  LockedFile file_;
  bool kept_ = false;
};

}  // namespace lte::train
