// The safetensors container: a JSON header with names, dtypes, shapes and string metadata, then raw
// little-endian data.
//
// Data sets, weights and checkpoints share it, so that Python reads them without us. Format:
// u64 header length | header JSON | data; offsets are relative to the data's start.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/base/file.h"
#include "lte/base/half.h"

namespace lte {

enum class DType { F16, BF16, F32, F64, I32, I64, U8 };

size_t dtype_size(DType dtype);
/// "F32", "BF16", ...: the names of the format.
const char* dtype_name(DType dtype);
template <typename T>
constexpr DType dtype_of();
template <>
constexpr DType dtype_of<Half>() {
  return DType::F16;
}
template <>
constexpr DType dtype_of<float>() {
  return DType::F32;
}
template <>
constexpr DType dtype_of<double>() {
  return DType::F64;
}
template <>
constexpr DType dtype_of<int32_t>() {
  return DType::I32;
}
template <>
constexpr DType dtype_of<int64_t>() {
  return DType::I64;
}
template <>
constexpr DType dtype_of<uint8_t>() {
  return DType::U8;
}

/// A borrowed, contiguous tensor.
struct TensorView {
  DType dtype = DType::F32;
  std::vector<int64_t> shape;
  const std::byte* data = nullptr;

  int64_t numel() const;
  size_t size_bytes() const { return static_cast<size_t>(numel()) * dtype_size(dtype); }
};

/// Metadata of every file that SafetensorsWriter writes.
inline constexpr const char* kChecksumKey = "lte_checksum";

/// Collects tensors (borrowed: they must outlive write()) and writes them. The data starts at a
/// multiple of 64 bytes; in it the tensors follow one another without gaps, which the format wants,
/// wide elements first and then by name, so that each is aligned to its element.
class SafetensorsWriter {
 public:
  /// @throws lte::Error if the name was added before or is "__metadata__", the shape has a negative
  ///         size or overflows, or there is no data.
  void add(const std::string& name, const TensorView& tensor);
  template <typename T>
  void add(const std::string& name, std::vector<int64_t> shape, const T* data) {
    add(name,
        TensorView{dtype_of<T>(), std::move(shape), reinterpret_cast<const std::byte*>(data)});
  }
  void set_metadata(const std::string& key, const std::string& value) { metadata_[key] = value; }

  /// Atomic. The same tensors and metadata give the same bytes. Adds the metadata
  /// kChecksumKey, the Checksum of the whole file in 16 hexadecimal digits, computed with zeros in
  /// their place.
  /// @throws lte::Error if the file cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  std::map<std::string, TensorView> tensors_;
  std::map<std::string, std::string> metadata_;
};

/// A mapped file whose header has been checked in full: JSON well formed and without repeated keys,
/// dtypes known, shapes non-negative and without overflow, ranges as long as shape times dtype
/// says, tiling the data without hole or overlap, and each aligned to its element.
class SafetensorsFile {
 public:
  /// @throws lte::Error naming `path` if it is missing, truncated or not safetensors.
  explicit SafetensorsFile(const std::filesystem::path& path);

  /// Reads the whole file against its checksum. One that has none, as other programs and earlier
  /// builds write them, passes.
  /// @throws lte::Error naming `path` if any bit of header or data is not as it was written.
  void verify() const;

  const std::filesystem::path& path() const { return path_; }
  bool contains(const std::string& name) const { return tensors_.count(name) > 0; }
  /// @throws lte::Error naming file and tensor if it is missing.
  const TensorView& at(const std::string& name) const;
  const std::map<std::string, TensorView>& tensors() const { return tensors_; }
  const std::map<std::string, std::string>& metadata() const { return metadata_; }
  /// @throws lte::Error naming file and key if it is missing.
  const std::string& metadata(const std::string& key) const;

  /// The tensor's values; checks dtype and shape (−1 in `shape` matches any size).
  /// @throws lte::Error naming file, tensor, expected and got.
  template <typename T>
  std::span<const T> values(const std::string& name, const std::vector<int64_t>& shape) const {
    const TensorView& tensor = checked(name, dtype_of<T>(), shape);
    return {reinterpret_cast<const T*>(tensor.data), static_cast<size_t>(tensor.numel())};
  }

 private:
  const TensorView& checked(const std::string& name, DType dtype,
                            const std::vector<int64_t>& shape) const;

  std::filesystem::path path_;
  std::shared_ptr<const MappedFile> file_;
  std::map<std::string, TensorView> tensors_;
  std::map<std::string, std::string> metadata_;
};

}  // namespace lte
