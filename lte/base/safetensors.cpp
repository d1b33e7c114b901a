#include "lte/base/safetensors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/text.h"

namespace lte {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little,
              "the format is little-endian, and so are its readers here");

constexpr size_t kPrefixSize = sizeof(uint64_t);
/// Alignment of the data's start in files that we write: a cache line.
constexpr size_t kDataAlignment = 64;
/// The limit of the reference implementation.
constexpr uint64_t kMaxHeaderSize = 100'000'000;
constexpr const char* kMetadataKey = "__metadata__";

struct DTypeInfo {
  DType dtype;
  const char* name;
  size_t size;
};
constexpr std::array<DTypeInfo, 7> kDTypes{{{DType::F16, "F16", 2},
                                            {DType::BF16, "BF16", 2},
                                            {DType::F32, "F32", 4},
                                            {DType::F64, "F64", 8},
                                            {DType::I32, "I32", 4},
                                            {DType::I64, "I64", 8},
                                            {DType::U8, "U8", 1}}};

const DTypeInfo& info(DType dtype) {
  for (const DTypeInfo& entry : kDTypes) {
    if (entry.dtype == dtype) return entry;
  }
  throw Error(concat("unknown dtype ", static_cast<int>(dtype)));
}

/// The name as JSON writes it, with control characters escaped: names come from files.
std::string shown_name(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string shape_text(const std::vector<int64_t>& shape) {
  std::string text = "[";
  for (size_t i = 0; i < shape.size(); ++i) text += concat(i > 0 ? ", " : "", shape[i]);
  return text + "]";
}

/// False if a size is negative or the bytes do not fit.
bool byte_count(const std::vector<int64_t>& shape, size_t element_size, uint64_t* bytes) {
  uint64_t product = element_size;
  bool empty = false;
  for (const int64_t size : shape) {
    if (size < 0) return false;
    if (size == 0) {
      empty = true;
    } else if (__builtin_mul_overflow(product, static_cast<uint64_t>(size), &product)) {
      return false;
    }
  }
  *bytes = empty ? 0 : product;
  return product <= static_cast<uint64_t>(INT64_MAX);
}

/// Parses the header, refusing keys that stand twice, of which the JSON library would silently keep
/// the last, and nesting that no valid header has.
Json parse_header(const std::string& path, const char* begin, const char* end) {
  constexpr int kMaxDepth = 3;
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    LTE_CHECK(depth <= kMaxDepth, path, ": not a safetensors file: its header is nested too deep");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& name = value.get_ref<const std::string&>();
      LTE_CHECK(keys.back().insert(name).second, path, ": header: ", shown_name(name),
                " stands there twice");
    }
    return true;
  };
  Json header;
  try {
    header = Json::parse(begin, end, watch);
  } catch (const Json::exception& error) {
    throw Error(concat(path, ": not a safetensors file: its header is not JSON: ", error.what()));
  }
  LTE_CHECK(header.is_object(), path, ": not a safetensors file: its header is not a JSON object");
  return header;
}

constexpr size_t kChecksumDigits = 16;
const std::string kNoChecksum(kChecksumDigits, '0');

/// Where the digits of the checksum stand in a header as we write it; npos if they do not. Quotes
/// within texts are escaped, so what is searched for is a key.
size_t checksum_place(std::string_view header) {
  const std::string key = concat('"', kChecksumKey, "\":\"");
  const size_t at = header.find(key);
  return at == std::string_view::npos ? at : at + key.size();
}

/// @param header   with zeros in place of the checksum
/// @param tensors  in the order of their data
std::string checksum_text(uint64_t header_size, const std::string& header,
                          const std::vector<TensorView>& tensors) {
  Checksum checksum;
  checksum.add(&header_size, sizeof(header_size));
  checksum.add(header);
  for (const TensorView& tensor : tensors) checksum.add(tensor.data, tensor.size_bytes());
  return formatted("%016llx", static_cast<unsigned long long>(checksum.value()));
}

/// A tensor of the header, with its range in the data.
struct Entry {
  std::string name;
  TensorView tensor;
  uint64_t begin = 0, end = 0;
};

Entry parse_entry(const std::string& path, const std::string& name, const Json& json) {
  const std::string where = concat(path, ": tensor ", shown_name(name), ": ");
  LTE_CHECK(json.is_object() && json.contains("dtype") && json.contains("shape") &&
                json.contains("data_offsets"),
            where, "expected dtype, shape and data_offsets");
  Entry entry;
  entry.name = name;
  const Json &dtype = json["dtype"], &shape = json["shape"], &offsets = json["data_offsets"];
  const auto known = std::find_if(kDTypes.begin(), kDTypes.end(), [&](const DTypeInfo& candidate) {
    return dtype.is_string() && dtype.get_ref<const std::string&>() == candidate.name;
  });
  LTE_CHECK(known != kDTypes.end(), where, "dtype ", dtype.dump(),
            " is none of F16, BF16, F32, F64, I32, I64, U8");
  entry.tensor.dtype = known->dtype;
  LTE_CHECK(shape.is_array(), where, "shape is not a list");
  for (const Json& size : shape) {
    LTE_CHECK(size.is_number_unsigned() && size.get<uint64_t>() <= static_cast<uint64_t>(INT64_MAX),
              where, "shape: expected non-negative integers, got ", size.dump());
    entry.tensor.shape.push_back(size.get<int64_t>());
  }
  uint64_t bytes = 0;
  LTE_CHECK(byte_count(entry.tensor.shape, known->size, &bytes), where, "shape ",
            shape_text(entry.tensor.shape), " is too large");
  LTE_CHECK(offsets.is_array() && offsets.size() == 2 && offsets[0].is_number_unsigned() &&
                offsets[1].is_number_unsigned(),
            where, "data_offsets: expected two non-negative integers");
  entry.begin = offsets[0].get<uint64_t>();
  entry.end = offsets[1].get<uint64_t>();
  LTE_CHECK(entry.begin <= entry.end && entry.end - entry.begin == bytes, where, "data_offsets [",
            entry.begin, ", ", entry.end, "] do not span the ", bytes, " bytes of ", known->name,
            " ", shape_text(entry.tensor.shape));
  return entry;
}

std::map<std::string, std::string> parse_metadata(const std::string& path, const Json& json) {
  LTE_CHECK(json.is_object(), path, ": ", kMetadataKey, ": expected a map of texts");
  std::map<std::string, std::string> metadata;
  for (const auto& [key, value] : json.items()) {
    LTE_CHECK(value.is_string(), path, ": metadata ", shown_name(key), ": expected a text");
    metadata[key] = value.get<std::string>();
  }
  return metadata;
}

/// The format wants the ranges to tile the data: no hole, no overlap, nothing behind the last.
void check_tiling(const std::string& path, std::vector<Entry>* entries, uint64_t data_size) {
  std::sort(entries->begin(), entries->end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.begin, a.end, a.name) < std::tie(b.begin, b.end, b.name);
  });
  uint64_t expected = 0;
  for (const Entry& entry : *entries) {
    LTE_CHECK(entry.begin == expected, path, ": tensor ", shown_name(entry.name),
              ": starts at byte ", entry.begin, " of the data instead of ", expected,
              entry.begin < expected ? " (overlap)" : " (hole)");
    LTE_CHECK(entry.end <= data_size, path, ": tensor ", shown_name(entry.name), ": ends at byte ",
              entry.end, " of the data, which has ", data_size, " (truncated file?)");
    expected = entry.end;
  }
  LTE_CHECK(expected == data_size, path, ": has ", data_size - expected,
            " bytes behind the last tensor");
}

}  // namespace

size_t dtype_size(DType dtype) { return info(dtype).size; }

const char* dtype_name(DType dtype) { return info(dtype).name; }

int64_t TensorView::numel() const {
  int64_t product = 1;
  for (const int64_t size : shape) product *= size;
  return product;
}

void SafetensorsWriter::add(const std::string& name, const TensorView& tensor) {
  uint64_t bytes = 0;
  LTE_CHECK(name != kMetadataKey, "tensor ", shown_name(name), ": the name is reserved");
  LTE_CHECK(byte_count(tensor.shape, dtype_size(tensor.dtype), &bytes), "tensor ", shown_name(name),
            ": bad shape ", shape_text(tensor.shape));
  LTE_CHECK(bytes == 0 || tensor.data != nullptr, "tensor ", shown_name(name), ": no data");
  LTE_CHECK(tensors_.emplace(name, tensor).second, "tensor ", shown_name(name), ": added twice");
}

void SafetensorsWriter::write(const std::filesystem::path& path) const {
  // Wide elements first, so that without gaps every tensor is aligned to its element.
  std::vector<std::pair<std::string, TensorView>> ordered(tensors_.begin(), tensors_.end());
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) {
    return dtype_size(a.second.dtype) > dtype_size(b.second.dtype);
  });
  Json header = Json::object();
  header[kMetadataKey] = metadata_;
  header[kMetadataKey][kChecksumKey] = kNoChecksum;
  uint64_t offset = 0;
  std::vector<TensorView> data;
  for (const auto& [name, tensor] : ordered) {
    data.push_back(tensor);
    const uint64_t end = offset + tensor.size_bytes();
    header[name] = {{"dtype", dtype_name(tensor.dtype)},
                    {"shape", tensor.shape},
                    {"data_offsets", {offset, end}}};
    offset = end;
  }
  std::string text;
  try {
    text = header.dump();
  } catch (const Json::exception& error) {
    throw Error(concat(path.string(), ": a name or metadata text is not UTF-8: ", error.what()));
  }
  const size_t excess = (kPrefixSize + text.size()) % kDataAlignment;
  if (excess > 0) text.append(kDataAlignment - excess, ' ');
  LTE_CHECK(text.size() <= kMaxHeaderSize, path.string(), ": the header would be ", text.size(),
            " bytes; the format allows ", kMaxHeaderSize);
  const uint64_t header_size = text.size();
  text.replace(checksum_place(text), kChecksumDigits, checksum_text(header_size, text, data));
  AtomicFile file(path);
  file.write(&header_size, sizeof(header_size));
  file.write(text);
  for (const auto& [name, tensor] : ordered) file.write(tensor.data, tensor.size_bytes());
  file.commit();
}

SafetensorsFile::SafetensorsFile(const std::filesystem::path& path)
    : path_(path), file_(std::make_shared<MappedFile>(path)) {
  const std::string name = path.string();
  LTE_CHECK(file_->size() >= kPrefixSize, name, ": not a safetensors file: only ", file_->size(),
            " bytes");
  uint64_t header_size = 0;
  std::memcpy(&header_size, file_->data(), sizeof(header_size));
  const uint64_t rest = file_->size() - kPrefixSize;
  LTE_CHECK(header_size <= kMaxHeaderSize && header_size <= rest, name,
            ": not a safetensors file, or truncated: a header of ", header_size,
            " bytes in a file of ", file_->size());
  const auto* text = reinterpret_cast<const char*>(file_->data()) + kPrefixSize;
  const Json header = parse_header(name, text, text + header_size);
  std::vector<Entry> entries;
  for (const auto& [key, value] : header.items()) {
    if (key == kMetadataKey) {
      metadata_ = parse_metadata(name, value);
    } else {
      entries.push_back(parse_entry(name, key, value));
    }
  }
  check_tiling(name, &entries, rest - header_size);
  const uint64_t data_begin = kPrefixSize + header_size;
  for (Entry& entry : entries) {
    const size_t alignment = dtype_size(entry.tensor.dtype);
    LTE_CHECK((data_begin + entry.begin) % alignment == 0, name, ": tensor ",
              shown_name(entry.name), ": starts at byte ", data_begin + entry.begin,
              ", not a multiple of its element's ", alignment, " bytes");
    entry.tensor.data = file_->data() + data_begin + entry.begin;
    tensors_.emplace(entry.name, std::move(entry.tensor));
  }
}

void SafetensorsFile::verify() const {
  const auto found = metadata_.find(kChecksumKey);
  if (found == metadata_.end()) return;
  uint64_t size = 0;
  std::memcpy(&size, file_->data(), kPrefixSize);
  std::string header(reinterpret_cast<const char*>(file_->data()) + kPrefixSize, size);
  std::vector<TensorView> data;
  for (const auto& [name, tensor] : tensors_) data.push_back(tensor);
  std::stable_sort(data.begin(), data.end(),
                   [](const TensorView& a, const TensorView& b) { return a.data < b.data; });
  const size_t at = checksum_place(header);
  bool same = at != std::string::npos && at + kChecksumDigits <= header.size() &&
              found->second.size() == kChecksumDigits;
  if (same) {
    header.replace(at, kChecksumDigits, kNoChecksum);
    same = found->second == checksum_text(size, header, data);
  }
  LTE_CHECK(same, path_.string(), ": damaged: its bytes do not give its checksum (metadata \"",
            kChecksumKey, "\"; a program that changes the file on purpose has to leave that out)");
}

const TensorView& SafetensorsFile::at(const std::string& name) const {
  const auto found = tensors_.find(name);
  LTE_CHECK(found != tensors_.end(), path_.string(), ": has no tensor ", shown_name(name));
  return found->second;
}

const std::string& SafetensorsFile::metadata(const std::string& key) const {
  const auto found = metadata_.find(key);
  LTE_CHECK(found != metadata_.end(), path_.string(), ": has no metadata ", shown_name(key));
  return found->second;
}

const TensorView& SafetensorsFile::checked(const std::string& name, DType dtype,
                                           const std::vector<int64_t>& shape) const {
  const TensorView& tensor = at(name);
  const auto matches = [](int64_t expected, int64_t got) {
    return expected == -1 || expected == got;
  };
  const bool same =
      tensor.dtype == dtype &&
      std::equal(shape.begin(), shape.end(), tensor.shape.begin(), tensor.shape.end(), matches);
  LTE_CHECK(same, path_.string(), ": tensor ", shown_name(name), ": expected ", dtype_name(dtype),
            " ", shape_text(shape), ", got ", dtype_name(tensor.dtype), " ",
            shape_text(tensor.shape));
  return tensor;
}

}  // namespace lte
