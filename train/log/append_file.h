// A file that grows piece by piece on a disk that may be full for a while.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lte::train {

class AppendFile {
 public:
  /// Opens the file, made if it is missing, to write at its end.
  /// @throws lte::Error if it cannot be opened.
  explicit AppendFile(std::filesystem::path path);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Appends all of it or nothing: what was written of a piece that did not fit is cut off again.
  /// @return whether it is there now; if not, fault() has the system's words
  bool append(std::string_view piece);
  const std::string& fault() const { return fault_; }

 private:
  int fd_;
  std::string fault_;
};

}  // namespace lte::train
