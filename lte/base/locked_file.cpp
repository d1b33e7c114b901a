#include "lte/base/locked_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"

namespace lte {

LockedFile::LockedFile(const std::filesystem::path& path) : path_(path) {
  // A file that its last holder removed between our opening and our locking is no file to hold.
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    open();
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      busy_ = errno == EWOULDBLOCK;
      if (!busy_)
        log_warning(path.string(), ": cannot lock: ", std::strerror(errno),
                    "; see to it that no other process writes it");
      return;
    }
    if (is_in_place()) return;
    ::close(fd_);
    fd_ = -1;
  }
  busy_ = true;
}

/// Opened for reading and writing: on NFS an exclusive lock needs a file open for writing.
void LockedFile::open() {
  constexpr int kFlags = O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC;
  fd_ = ::open(path_.c_str(), kFlags | O_EXCL, 0666);
  made_ = fd_ >= 0;
  if (!made_) fd_ = ::open(path_.c_str(), kFlags, 0666);
  if (fd_ < 0) fail_on_file(path_, "cannot open for writing", errno);
}

/// Whether the path still leads to the file that is open.
bool LockedFile::is_in_place() const {
  struct stat held {};
  struct stat there {};
  return ::fstat(fd_, &held) == 0 && ::stat(path_.c_str(), &there) == 0 &&
         held.st_dev == there.st_dev && held.st_ino == there.st_ino;
}

void LockedFile::remove() { ::unlink(path_.c_str()); }

LockedFile::~LockedFile() { ::close(fd_); }

void LockedFile::append(std::string_view text) {
  for (size_t written = 0; written < text.size();) {
    const ssize_t count = ::write(fd_, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) fail_on_file(path_, "cannot write", errno);
    if (count > 0) written += static_cast<size_t>(count);
  }
  ::fsync(fd_);  // what cannot be synchronized is written all the same
}

}  // namespace lte
