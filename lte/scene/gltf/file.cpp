#include "lte/scene/gltf/file.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "lte/base/check.h"

namespace lte::scene::gltf {
namespace {

static_assert(std::endian::native == std::endian::little,
              "glTF is little-endian, and read as it lies");

constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kMaxNesting = 128;

uint32_t word(Bytes bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

std::string_view text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Splits a GLB into its JSON, which is returned, and its BIN chunk.
Bytes read_chunks(const std::string& name, Bytes bytes, Bytes* binary) {
  LTE_CHECK(bytes.size() >= 20, name, ": truncated .glb, ", bytes.size(),
            " bytes are less than its header");
  LTE_CHECK(word(bytes, 4) == 2, name, ": .glb of version ", word(bytes, 4),
            ", only 2 is understood");
  const size_t length = word(bytes, 8);
  LTE_CHECK(length <= bytes.size(), name, ": truncated .glb, its header promises ", length,
            " bytes, the file has ", bytes.size());
  LTE_CHECK(length >= 20, name, ": .glb header with an impossible length of ", length, " bytes");
  bytes = bytes.first(length);
  Bytes json;
  size_t offset = 12;
  for (int chunk = 0; offset + 8 <= bytes.size(); ++chunk) {
    const size_t size = word(bytes, offset);
    const uint32_t kind = word(bytes, offset + 4);
    LTE_CHECK(size <= bytes.size() - offset - 8, name, ": truncated .glb, chunk ", chunk,
              " promises ", size, " bytes, ", bytes.size() - offset - 8, " are left");
    const Bytes content = bytes.subspan(offset + 8, size);
    LTE_CHECK(chunk != 0 || kind == kJsonChunk, name, ": the first chunk of the .glb is not JSON");
    if (chunk == 0) json = content;
    if (chunk == 1 && kind == kBinChunk) *binary = content;
    offset += 8 + (size + 3) / 4 * 4;
  }
  return json;
}

/// Deepest nesting of brackets outside strings: parsers further down use recursion.
int nesting(std::string_view json) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

Json parse_json(const std::string& name, std::string_view json) {
  if (json.starts_with("\xEF\xBB\xBF"))
    json.remove_prefix(3);  // a byte order mark, which some editors leave
  const size_t start = json.find_first_not_of(" \t\r\n");
  LTE_CHECK(start != std::string_view::npos && json[start] == '{', name,
            ": not a glTF file (neither the magic of a .glb nor a JSON object)");
  LTE_CHECK(nesting(json) <= kMaxNesting, name, ": JSON nested deeper than ", kMaxNesting,
            " levels");
  try {
    return Json::parse(json);
  } catch (const Json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 3: ..." from its own text on.
    const std::string what = error.what();
    throw Error(concat(
        name, ": not valid JSON: ", what.substr(std::min(what.size(), what.find("] ") + 2))));
  }
}

}  // namespace

File open_file(SceneFiles* files) {
  File file;
  file.source = files->open_scene();
  file.name = file.source->name();
  Bytes json = file.source->bytes();
  LTE_CHECK(!json.empty(), file.name, ": the file is empty");
  if (json.size() >= 4 && word(json, 0) == kMagic)
    json = read_chunks(file.name, json, &file.binary);
  file.json = parse_json(file.name, text(json));
  return file;
}

}  // namespace lte::scene::gltf
