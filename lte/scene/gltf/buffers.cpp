// The bytes of buffers and images: from files beside the scene, data URIs or the BIN chunk.
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/file.h"

namespace lte::scene::gltf {
namespace {

constexpr int8_t kNotBase64 = -1;

std::array<int8_t, 256> base64_table() {
  std::array<int8_t, 256> table;
  table.fill(kNotBase64);
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < kAlphabet.size(); ++i) {
    table[static_cast<uint8_t>(kAlphabet[i])] = static_cast<int8_t>(i);
  }
  return table;
}

std::vector<std::byte> decode_base64(std::string_view text, const std::string& where) {
  static const std::array<int8_t, 256> kTable = base64_table();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int held = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const int8_t digit = kTable[static_cast<uint8_t>(text[i])];
    LTE_CHECK(digit != kNotBase64, where, ": character ", i, " of its data URI is not base64");
    bits = (bits << 6) | static_cast<uint32_t>(digit);
    held += 6;
    if (held >= 8) {
      held -= 8;
      out.push_back(static_cast<std::byte>((bits >> held) & 0xff));
    }
  }
  return out;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// "my%20file.bin" -> "my file.bin"; a stray per cent sign stays.
std::string decode_percent(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    const int high = i + 2 < uri.size() && uri[i] == '%' ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    if (low >= 0) {
      out.push_back(static_cast<char>(high * 16 + low));
      i += 2;
    } else {
      out.push_back(uri[i]);
    }
  }
  return out;
}

}  // namespace

Bytes Buffers::fetch(const std::string& uri, const std::string& element) {
  const std::string where = concat(file_.name, ": ", element);
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    LTE_CHECK(comma != std::string::npos && uri.substr(0, comma).ends_with(";base64"), where,
              ": data URI without base64: ", shown_reference(uri));
    decoded_.push_back(std::make_unique<std::vector<std::byte>>(
        decode_base64(std::string_view(uri).substr(comma + 1), where)));
    return *decoded_.back();
  }
  const std::filesystem::path relative = decode_percent(uri);
  LTE_CHECK(uri.find("://") == std::string::npos && relative.is_relative(), where, ": URI ",
            shown_reference(uri), " is not relative to the file; nothing else is fetched");
  const SceneFilePtr opened = files_->open({files_->scene().parent_path() / relative}, uri, where);
  LTE_CHECK(opened, where, ": cannot find the file ", shown_reference(uri), " beside it");
  has_outside_ |= opened->outside();
  opened_.push_back(opened);
  return opened->bytes();
}

Buffers::Buffers(const File& file, SceneFiles* files) : file_(file), files_(files) {
  std::vector<Bytes> buffers;
  const Json none = Json::array();
  const Json& buffer_list = file.json.contains("buffers") ? file.json["buffers"] : none;
  for (size_t i = 0; i < buffer_list.size(); ++i) {
    const Json& buffer = buffer_list[i];
    const std::string element = concat("buffers[", i, "]");
    Bytes bytes;
    if (buffer.contains("uri")) {
      bytes = fetch(buffer["uri"].get_ref<const std::string&>(), element);
    } else {
      LTE_CHECK(i == 0 && !file.binary.empty(), file.name, ": ", element,
                " has no uri, and the file has no BIN chunk for it");
      bytes = file.binary;
    }
    const auto length = buffer["byteLength"].get<uint64_t>();
    LTE_CHECK(length <= bytes.size(), file.name, ": ", element, " is truncated: byteLength is ",
              length, ", ", bytes.size(), " bytes are there");
    buffers.push_back(bytes.first(length));
  }
  const Json& view_list = file.json.contains("bufferViews") ? file.json["bufferViews"] : none;
  for (size_t i = 0; i < view_list.size(); ++i) {
    const Json& view = view_list[i];
    const Bytes bytes = buffers[view["buffer"].get<size_t>()];
    const uint64_t offset = view.value("byteOffset", uint64_t{0});
    const auto length = view["byteLength"].get<uint64_t>();
    LTE_CHECK(offset <= bytes.size() && length <= bytes.size() - offset, file.name,
              ": bufferViews[", i, "] covers bytes ", offset, " to ", offset, " + ", length,
              " of a buffer of ", bytes.size(), " bytes");
    views_.push_back(bytes.subspan(offset, length));
  }
}

Bytes Buffers::image(int index) {
  const Json& image = file_.json["images"][static_cast<size_t>(index)];
  if (image.contains("bufferView")) return view(image["bufferView"].get<int>());
  return fetch(image["uri"].get_ref<const std::string&>(), concat("images[", index, "]"));
}

}  // namespace lte::scene::gltf
