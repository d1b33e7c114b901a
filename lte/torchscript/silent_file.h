// A file for writers that must not see a failure half-way.
#pragma once

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <streambuf>

namespace lte::torchscript {

/// LibTorch's writer of archives ends the process where its stream fails: it throws, and its
/// destructor, which then writes the archive's end, throws again. So this takes everything, and
/// close() tells of the first failure; what came after it was dropped.
class SilentFile : public std::streambuf {
 public:
  explicit SilentFile(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "wbe")) {
    if (file_ == nullptr) error_ = errno;
  }
  ~SilentFile() override { close(); }

  /// @return  the system's number of the first failure, 0 if there was none
  int close() {
    if (file_ != nullptr && std::fclose(file_) != 0 && error_ == 0) error_ = errno;
    file_ = nullptr;
    return error_;
  }

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    const auto size = static_cast<size_t>(count);
    if (error_ == 0 && std::fwrite(bytes, 1, size, file_) != size) error_ = errno;
    return count;
  }

  int_type overflow(int_type next) override {
    const char byte = traits_type::to_char_type(next);
    if (!traits_type::eq_int_type(next, traits_type::eof())) xsputn(&byte, 1);
    return traits_type::not_eof(next);
  }

  int sync() override { return 0; }

 private:
  std::FILE* file_;
  int error_ = 0;
};

}  // namespace lte::torchscript
