// Files: written aside and renamed, mapped for reading, listed.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace lte {

/// A file that appears whole or not at all: bytes go to a temporary name beside it; commit()
/// flushes, fsyncs and renames. Without commit() the destructor removes the temporary, and the
/// handler that install_signal_cleanup() sets does so on Ctrl-C. Every failure throws lte::Error
/// that names `path` and the system's reason (permission, disk full).
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
