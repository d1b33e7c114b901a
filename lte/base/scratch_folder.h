// A folder for files that are written and read back at once.
#pragma once

#include <filesystem>

namespace lte {

/// Made for this user alone under the system's folder for such; removed with all in it.
class ScratchFolder {
 public:
  /// @throws lte::Error naming the path and the system's reason.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lte
