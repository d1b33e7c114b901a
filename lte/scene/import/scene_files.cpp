#include "lte/scene/import/scene_files.h"

#include <cerrno>
#include <climits>
#include <cstring>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lte/base/file.h"

namespace lte::scene {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_;
};

std::string proc_name(int fd) { return concat("/proc/self/fd/", fd); }

std::optional<struct stat> status_of(int fd) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return std::nullopt;
  return info;
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// Where an open file lies, links resolved: the kernel's word for the file that is open, so that
/// nobody can exchange a folder for a link between this and a look at the name. Without /proc, the
/// name's canonical form if it still leads to that file. Empty where nothing can be said.
std::string place_of(int fd, const fs::path& path) {
  std::string place(PATH_MAX, '\0');
  const ssize_t length = ::readlink(proc_name(fd).c_str(), place.data(), place.size());
  if (length > 0) {
    place.resize(static_cast<size_t>(length));
    return place;
  }
  std::error_code error;
  const fs::path canonical = fs::canonical(path, error);
  struct stat there {};
  const std::optional<struct stat> opened = status_of(fd);
  const bool same =
      !error && ::lstat(canonical.c_str(), &there) == 0 && opened && same_file(*opened, there);
  return same ? canonical.string() : "";
}

/// Whether a canonical path is that of a canonical folder or lies in it.
bool lies_in(const std::string& place, const std::string& folder) {
  if (folder.empty() || place.empty()) return false;
  if (folder == "/") return place.starts_with('/');
  if (!place.starts_with(folder)) return false;
  return place.size() == folder.size() || place[folder.size()] == '/';
}

/// Opens a file that is known to be regular for reading, by the descriptor that looked at it.
Descriptor open_for_reading(int looked, const fs::path& path) {
  const int flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  const int fd = ::open(proc_name(looked).c_str(), flags);
  if (fd >= 0 || errno != ENOENT) return Descriptor(fd);
  // Without /proc by name again; another file than before is none.
  const int again = ::open(path.c_str(), flags);
  if (again < 0) return Descriptor(again);
  const std::optional<struct stat> before = status_of(looked), now = status_of(again);
  if (before && now && same_file(*before, *now)) return Descriptor(again);
  ::close(again);
  errno = ESTALE;
  return Descriptor(-1);
}

/// Where an absolute path that leads to no file would lead, links to nowhere followed too, which
/// fs::weakly_canonical() leaves alone. Empty for links that go round in circles.
fs::path resolve_missing(fs::path path, std::error_code& error) {
  constexpr int kMaxLinks = 40;  // as many as the kernel follows
  for (int links = 0; links < kMaxLinks; ++links) {
    path = fs::weakly_canonical(path, error);
    if (error) return {};
    std::error_code ignored;
    fs::path reached, next;
    for (const fs::path& part : path) {
      if (!next.empty()) {
        next /= part;
        continue;
      }
      reached /= part;
      if (fs::is_symlink(reached, ignored))
        next = reached.parent_path() / fs::read_symlink(reached, ignored);
    }
    if (next.empty()) return path;
    path = next;
  }
  return {};
}

bool is_missing(int error) { return error == ENOENT || error == ENOTDIR || error == ENAMETOOLONG; }

}  // namespace

SceneFile::SceneFile(fs::path path, int descriptor, bool outside)
    : path_(std::move(path)), name_(path_.string()), outside_(outside) {
  const std::optional<struct stat> info = status_of(descriptor);
  LTE_CHECK(info && S_ISREG(info->st_mode), name_, ": cannot read: not a regular file");
  identity_ = {info->st_dev, info->st_ino};
  size_ = static_cast<size_t>(info->st_size);
  note_read(descriptor);
  if (size_ == 0) return;  // mmap refuses an empty range
  void* const data = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
  LTE_CHECK(data != MAP_FAILED, name_, ": cannot map: ", std::strerror(errno));
  data_ = static_cast<const std::byte*>(data);
}

SceneFile::~SceneFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

SceneFiles::SceneFiles(const fs::path& scene, const LoadLimits& limits)
    : scene_(scene), budget_(limits) {
  const fs::path parent = scene.has_parent_path() ? scene.parent_path() : fs::path(".");
  const Descriptor folder(::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (folder) folder_ = place_of(folder.get(), parent);
}

SceneFilePtr SceneFiles::open_scene() {
  const std::string name = scene_.string();
  // O_PATH looks and does not open: a device or a pipe notices nothing.
  const Descriptor looked(::open(scene_.c_str(), O_PATH | O_CLOEXEC));
  LTE_CHECK(looked || !is_missing(errno), name, ": no such file");
  LTE_CHECK(looked, name, ": cannot read: ", std::strerror(errno));
  const std::optional<struct stat> info = status_of(looked.get());
  LTE_CHECK(info && !S_ISDIR(info->st_mode), name, ": is a directory");
  LTE_CHECK(S_ISREG(info->st_mode), name, ": not a regular file");
  const Descriptor file = open_for_reading(looked.get(), scene_);
  LTE_CHECK(file, name, ": cannot read: ", std::strerror(errno));
  return std::make_shared<const SceneFile>(scene_, file.get(), /*outside=*/false);
}

SceneFiles::Found SceneFiles::look(const fs::path& path, SceneFilePtr* file) {
  const Descriptor looked(::open(path.c_str(), O_PATH | O_CLOEXEC));
  const bool allowed = limits().outside;
  if (!looked) {
    const int reason = errno;
    // Whether there is a file outside stays unsaid, too.
    std::error_code error;
    fs::path place = fs::absolute(path, error);
    if (!error) place = resolve_missing(place, error);
    if (error)
      place =
          (fs::path(folder_) / path.lexically_relative(scene_.parent_path())).lexically_normal();
    if (!allowed && !lies_in(place.string(), folder_)) return Found::Outside;
    LTE_CHECK(is_missing(reason), path.string(), ": cannot read: ", std::strerror(reason));
    return Found::Missing;
  }
  const bool outside = !lies_in(place_of(looked.get(), path), folder_);
  if (outside && !allowed) return Found::Outside;
  const std::optional<struct stat> info = status_of(looked.get());
  if (!info || !S_ISREG(info->st_mode)) return Found::Special;
  const Descriptor opened = open_for_reading(looked.get(), path);
  LTE_CHECK(opened, path.string(), ": cannot read: ", std::strerror(errno));
  *file = std::make_shared<const SceneFile>(path, opened.get(), outside);
  return Found::File;
}

SceneFilePtr SceneFiles::open(const std::vector<fs::path>& candidates, const std::string& reference,
                              const std::string& where, Special special) {
  bool is_outside = false, is_special = false;
  for (const fs::path& path : candidates) {
    // A name with a zero byte would end early in the system's eyes.
    if (path.empty() || path.native().find('\0') != std::string::npos) continue;
    std::weak_ptr<const SceneFile>& known = open_[path.native()];
    SceneFilePtr file = known.lock();
    if (file) return file;
    const Found found = look(path, &file);
    if (found == Found::File) {
      known = file;
      return file;
    }
    is_outside |= found == Found::Outside;
    is_special |= found == Found::Special;
  }
  if (is_outside)
    throw OutsideFolder(concat(where, ": ", shown_reference(reference),
                               " lies outside the folder of the scene's file, and nothing there is "
                               "read unless that is allowed"));
  LTE_CHECK(!is_special || special == Special::IsMissing, where, ": ", shown_reference(reference),
            " is not a regular file");
  return nullptr;
}

std::string shown_reference(std::string_view reference) {
  constexpr size_t kLongest = 80;
  std::string out = "\"";
  for (const char c : reference.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  return out + (reference.size() > kLongest ? "...\"" : "\"");
}

std::string discreet_message(const SceneFile& file, const char* kind, std::string_view message) {
  std::string place = file.name();
  if (message.starts_with(place)) {
    message.remove_prefix(place.size());
    for (const std::string_view word : {": line ", ":"}) {
      const size_t end =
          std::min(message.find_first_not_of("0123456789", word.size()), message.size());
      if (!message.starts_with(word) || end <= word.size()) continue;
      place += message.substr(0, end);
      break;
    }
  }
  return concat(place, ": not a valid ", kind,
                "; it lies outside the scene's folder, and nothing of it is quoted");
}

}  // namespace lte::scene
