#include "lte/cli/writable.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "lte/base/check.h"

namespace lte {

void check_writable(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty()) return;
  std::error_code error;
  LTE_CHECK(!fs::is_directory(path, error), path, ": cannot be written: is a folder");
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    LTE_CHECK(::access(path.c_str(), W_OK) == 0, path,
              ": cannot be written: ", std::strerror(errno));
    return;
  }
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  LTE_CHECK(::access(folder.c_str(), W_OK) == 0, path,
            ": cannot be written: ", std::strerror(errno));
  LTE_CHECK(fs::is_directory(folder, error), path, ": cannot be written: ", folder,
            " is not a folder");
}

}  // namespace lte
