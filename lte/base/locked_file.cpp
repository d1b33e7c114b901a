#include "lte/base/locked_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/log.h"

namespace lte {

// Opened for reading and writing: on NFS an exclusive lock needs a file open for writing.
LockedFile::LockedFile(const std::filesystem::path& path)
    : path_(path), fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  LTE_CHECK(fd_ >= 0, path.string(), ": cannot open for writing: ", std::strerror(errno));
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  busy_ = errno == EWOULDBLOCK;
  if (!busy_)
    log_warning(path.string(), ": cannot lock: ", std::strerror(errno),
                "; see to it that no other process writes it");
}

LockedFile::~LockedFile() { ::close(fd_); }

void LockedFile::append(std::string_view text) {
  for (size_t written = 0; written < text.size();) {
    const ssize_t count = ::write(fd_, text.data() + written, text.size() - written);
    LTE_CHECK(count >= 0 || errno == EINTR, path_.string(),
              ": cannot write: ", std::strerror(errno));
    if (count > 0) written += static_cast<size_t>(count);
  }
  ::fsync(fd_);  // what cannot be synchronized is written all the same
}

}  // namespace lte
