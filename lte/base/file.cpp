#include "lte/base/file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>
#include <random>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lte/base/check.h"

namespace lte {
namespace {

namespace fs = std::filesystem;

/// The names of the temporaries that exist now. A signal handler may touch neither the heap nor a
/// lock, hence fixed buffers with one atomic state each.
class Registry {
 public:
  /// A file beyond the registry's capacity is still removed by its destructor, only not on a
  /// signal.
  void add(const std::string& name) {
    if (name.size() >= kNameSize) return;
    for (Slot& slot : slots_) {
      int expected = kFree;
      if (!slot.state.compare_exchange_strong(expected, kFilling)) continue;
      std::memcpy(slot.name.data(), name.c_str(), name.size() + 1);
      slot.state = kReady;
      return;
    }
  }

  void remove(const std::string& name) {
    for (Slot& slot : slots_) {
      if (slot.state == kReady && name == slot.name.data()) {
        slot.state = kFree;
        return;
      }
    }
  }

  /// Async-signal-safe.
  void unlink_all() {
    for (Slot& slot : slots_) {
      if (slot.state == kReady) ::unlink(slot.name.data());
    }
  }

 private:
  static constexpr size_t kNameSize = 4096;
  enum State { kFree, kFilling, kReady };
  struct Slot {
    std::atomic<int> state{kFree};
    std::array<char, kNameSize> name{};
  };
  std::array<Slot, 64> slots_;
};
static_assert(std::atomic<int>::is_always_lock_free, "the signal handler reads these");

Registry g_registry;

/// The text of the SignalNote that lives. The size is set last and cleared first, so that the
/// handler never meets half a text.
std::array<char, 512> g_note;
std::atomic<size_t> g_note_size{0};
static_assert(std::atomic<size_t>::is_always_lock_free, "the signal handler reads it");

extern "C" void remove_temporaries_and_exit(int signal) {
  g_registry.unlink_all();
  const size_t size = g_note_size;
  if (size > 0 && ::write(STDERR_FILENO, g_note.data(), size) < 0) _exit(128 + signal);
  _exit(128 + signal);
}

std::mutex g_watch_mutex;
std::vector<ReadWatch*> g_watches;

/// The file that `path` leads to, so that a symbolic link survives; `path` itself, made absolute,
/// if it is no link.
fs::path resolve(const fs::path& path) {
  std::error_code error;
  if (fs::is_symlink(path, error)) {
    const fs::path target = fs::weakly_canonical(path, error);
    if (!error) return target;
  }
  const fs::path absolute = fs::absolute(path, error);
  return error ? path : absolute;
}

/// Makes the rename durable. Some file systems cannot sync a directory, which is no reason to fail.
void sync_directory(const fs::path& directory) {
  const int fd = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

constexpr const char* kTemporaryMark = ".tmp-";

/// Tells this process from all others. Its number alone would not do: on a shared file system,
/// processes of several machines may have the same one.
const std::string& process_token() {
  static const std::string token = concat(::getpid(), "-", std::random_device{}());
  return token;
}

}  // namespace

void fail_on_file(const fs::path& path, const std::string& what, int system_error) {
  const std::string text = concat(path.string(), ": ", what, ": ", std::strerror(system_error));
  // EFBIG: beyond the limit of this process (ulimit -f), to which no other file is an exception.
  if (system_error == ENOSPC || system_error == EDQUOT || system_error == EFBIG)
    throw DiskFull(text);
  throw Error(text);
}

AtomicFile::AtomicFile(const fs::path& path) : path_(path) {
  static std::atomic<uint64_t> counter{0};
  const fs::path target = resolve(path);
  struct stat info {};
  const bool exists = ::stat(target.c_str(), &info) == 0;
  LTE_CHECK(!exists || !S_ISDIR(info.st_mode), path.string(), ": cannot write: is a directory");
  LTE_CHECK(target.has_filename(), path.string(), ": cannot write: not the name of a file");
  if (exists && !S_ISREG(info.st_mode)) {
    // A device or pipe cannot be replaced by a file of that name: write straight into it.
    temporary_ = path_;
    file_ = std::fopen(path_.c_str(), "we");
    if (file_ == nullptr) fail_on_file(path_, "cannot write", errno);
    return;
  }
  path_ = target;
  temporary_ = target.parent_path() / concat(".", target.filename().string(), kTemporaryMark,
                                             process_token(), "-", counter.fetch_add(1));
  // Registered first: a signal between the two lines finds nothing to remove, not a file that
  // nobody knows.
  g_registry.add(temporary_.string());
  const int fd = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd >= 0) file_ = ::fdopen(fd, "wb");
  if (file_ == nullptr) {
    const int error = errno;
    if (fd >= 0) {
      ::close(fd);
      ::unlink(temporary_.c_str());
    }
    g_registry.remove(temporary_.string());
    fail_on_file(path,
                 error == ENOENT ? "cannot create: its directory does not exist" : "cannot create",
                 error);
  }
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  if (temporary_ == path_) return;
  ::unlink(temporary_.c_str());
  g_registry.remove(temporary_.string());
}

void AtomicFile::write(const void* bytes, size_t size) {
  LTE_CHECK(file_ != nullptr, path_.string(), ": cannot write: already committed");
  if (size > 0 && std::fwrite(bytes, 1, size, file_) != size)
    fail_on_file(path_, "cannot write", errno);
}

void AtomicFile::commit() {
  LTE_CHECK(file_ != nullptr, path_.string(), ": cannot write: already committed");
  const bool direct = temporary_ == path_;
  // On failure file_ stays open and the destructor cleans up.
  if (std::fflush(file_) != 0) fail_on_file(path_, "cannot write", errno);
  if (!direct && ::fsync(::fileno(file_)) != 0) fail_on_file(path_, "cannot write", errno);
  if (!direct && ::rename(temporary_.c_str(), path_.c_str()) != 0) {
    fail_on_file(path_, "cannot rename the finished file", errno);
  }
  const int closed = std::fclose(file_);
  const int error = errno;
  file_ = nullptr;
  if (!direct) {
    g_registry.remove(temporary_.string());
    sync_directory(path_.parent_path());
  }
  if (closed != 0) fail_on_file(path_, "cannot write", error);
}

void write_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

std::string read_file(const fs::path& path, size_t limit_bytes) {
  LTE_CHECK(!fs::is_directory(path), path.string(), ": cannot read: is a directory");
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr) fail_on_file(path, "cannot read", errno);
  note_read(::fileno(file));
  std::string text;
  std::array<char, 65536> buffer;
  size_t got = 0;
  while ((got = std::fread(buffer.data(), 1, buffer.size(), file)) > 0 &&
         text.size() <= limit_bytes) {
    text.append(buffer.data(), got);
  }
  const int error = std::ferror(file) != 0 ? errno : 0;
  std::fclose(file);
  if (error != 0) fail_on_file(path, "cannot read", error);
  LTE_CHECK(text.size() <= limit_bytes, path.string(), ": is larger than the limit of ",
            limit_bytes, " bytes");
  return text;
}

void make_directory(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  LTE_CHECK(!error, path.string(), ": cannot make the directory: ", error.message());
}

std::string temporary_of(const std::string& name) {
  const size_t mark = name.rfind(kTemporaryMark);
  return !name.starts_with('.') || mark == std::string::npos ? "" : name.substr(1, mark - 1);
}

void install_signal_cleanup() {
  struct sigaction action {};
  action.sa_handler = remove_temporaries_and_exit;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A file that meets the limit of `ulimit -f` then fails like one on a full disk: in one line.
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

SignalNote::SignalNote(std::string_view line) {
  constexpr size_t kMax = 500;
  // A progress bar may stand on the terminal's last line.
  const std::string text =
      concat(::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", line.substr(0, kMax), "\n");
  std::memcpy(g_note.data(), text.data(), text.size());
  g_note_size = text.size();
}

SignalNote::~SignalNote() { g_note_size = 0; }

void note_read(int fd) {
  const std::lock_guard lock(g_watch_mutex);
  struct stat info {};
  if (g_watches.empty() || ::fstat(fd, &info) != 0) return;
  for (ReadWatch* watch : g_watches) watch->note(info.st_dev, info.st_ino);
}

ReadWatch::ReadWatch() {
  const std::lock_guard lock(g_watch_mutex);
  g_watches.push_back(this);
}

ReadWatch::~ReadWatch() {
  const std::lock_guard lock(g_watch_mutex);
  std::erase(g_watches, this);
}

bool ReadWatch::saw(const fs::path& path) const {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return false;
  const std::lock_guard lock(g_watch_mutex);
  return seen_.contains({info.st_dev, info.st_ino});
}

MappedFile::MappedFile(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) fail_on_file(path, "cannot read", errno);
  note_read(fd);
  struct stat info {};
  const bool regular = ::fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  size_ = regular ? static_cast<size_t>(info.st_size) : 0;
  void* data = nullptr;
  int error = 0;
  if (size_ > 0) {  // mmap refuses an empty range
    data = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fd, 0);
    if (data == MAP_FAILED) error = errno;
  }
  ::close(fd);
  LTE_CHECK(regular, path.string(), ": cannot read: not a regular file");
  if (error != 0) fail_on_file(path, "cannot map", error);
  data_ = static_cast<const std::byte*>(data);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace lte
