#include "train/log/append_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lte/base/check.h"

namespace lte::train {

AppendFile::AppendFile(std::filesystem::path path)
    : fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  LTE_CHECK(fd_ >= 0, path.string(), ": cannot append: ", std::strerror(errno));
}

AppendFile::~AppendFile() { ::close(fd_); }

bool AppendFile::append(std::string_view piece) {
  struct stat before {};
  const bool known = ::fstat(fd_, &before) == 0 && S_ISREG(before.st_mode);
  for (size_t written = 0; written < piece.size();) {
    const ssize_t count = ::write(fd_, piece.data() + written, piece.size() - written);
    if (count > 0) written += static_cast<size_t>(count);
    if (count >= 0 || errno == EINTR) continue;
    fault_ = std::strerror(errno);
    // Shortening a file needs no room. Where it fails all the same, readers skip half a line.
    if (known && ::ftruncate(fd_, before.st_size) != 0)
      fault_ += concat(", nor cut back to ", before.st_size, " bytes");
    return false;
  }
  return true;
}

}  // namespace lte::train
