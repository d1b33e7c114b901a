// Files: written aside and renamed, mapped for reading, listed.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <sys/types.h>

#include "lte/base/check.h"

namespace lte {

/// A file could not be written because the disk, the user's share of it, or what the process may
/// write is full: whatever is written next will fail too.
class DiskFull : public Error {
 public:
  using Error::Error;
};

/// Throws DiskFull, or Error for another reason to fail: "path: what: the system's words".
[[noreturn]] void fail_on_file(const std::filesystem::path& path, const std::string& what,
                               int system_error);

/// A file that appears whole or not at all: bytes go to a temporary name beside it; commit()
/// flushes, fsyncs and renames. Without commit() the destructor removes the temporary, and the
/// handler that install_signal_cleanup() sets does so on Ctrl-C. Every failure throws lte::Error
/// that names `path` and the system's reason (permission, ...); a full disk is DiskFull.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* bytes, size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();

  /// The temporary, already created, for libraries that insist on a file name. commit() renames it
  /// all the same.
  const std::filesystem::path& temporary_path() const { return temporary_; }

 private:
  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
};

/// Writes `text` to `path` through AtomicFile.
void write_file(const std::filesystem::path& path, std::string_view text);

/// @throws lte::Error if it cannot be read or is larger than `limit_bytes`.
std::string read_file(const std::filesystem::path& path, size_t limit_bytes = size_t{1} << 30);

/// Makes the directory and its parents. Nothing happens where it exists already.
/// @throws lte::Error naming the path and the system's reason.
void make_directory(const std::filesystem::path& path);

/// The file that `name` is a temporary of, if AtomicFile gave that name; empty otherwise.
std::string temporary_of(const std::string& name);

/// Makes SIGINT and SIGTERM remove the temporaries of unfinished AtomicFiles and exit with 128 +
/// the signal's number.
void install_signal_cleanup();

/// What that handler prints on standard error before it exits, while the object lives; one at a
/// time.
class SignalNote {
 public:
  /// @param line  without a line break; cut to 500 bytes
  explicit SignalNote(std::string_view line);
  ~SignalNote();
  SignalNote(const SignalNote&) = delete;
  SignalNote& operator=(const SignalNote&) = delete;
};

/// Notes, while it lives, which files this process reads with read_file() and MappedFile, or tells
/// by note_read().
class ReadWatch {
 public:
  ReadWatch();
  ~ReadWatch();
  ReadWatch(const ReadWatch&) = delete;
  ReadWatch& operator=(const ReadWatch&) = delete;

  /// Whether the file that `path` leads to was read, by whatever name.
  bool saw(const std::filesystem::path& path) const;
  /// For those who read.
  void note(dev_t device, ino_t inode) { seen_.emplace(device, inode); }

 private:
  std::set<std::pair<dev_t, ino_t>> seen_;
};

/// Tells every ReadWatch that the file behind a descriptor is read.
void note_read(int descriptor);

/// A read-only memory map of a file.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::byte* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace lte
