// Writes small glTF files for tests, member by member, without any of the code under test.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/temp_dir.h"

namespace lte::test {

using Json = nlohmann::json;

inline std::string base64(const std::string& bytes) {
  static const char* const kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) {
      out += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18 - 6 * k) & 63];
    }
  }
  return out;
}

enum : int {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

/// A document under construction: `json` is public, so that a test can spoil any member.
struct GltfBuilder {
  Json json{{"asset", {{"version", "2.0"}}}};
  std::string bytes;  ///< of the one buffer

  /// Buffer view of raw values; returns its index.
  template <typename T>
  int view(const std::vector<T>& values, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    Json item{
        {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) item["byteStride"] = stride;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["bufferViews"].push_back(item);
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  /// Accessor over all of `values`; `type` is SCALAR, VEC2, ...
  template <typename T>
  int accessor(const std::vector<T>& values, int component_type, const std::string& type,
               bool normalized = false) {
    const size_t width = type == "SCALAR" ? 1 : static_cast<size_t>(type[3] - '0');
    Json item{{"bufferView", view(values)},
              {"componentType", component_type},
              {"count", values.size() / width},
              {"type", type}};
    if (normalized) item["normalized"] = true;
    json["accessors"].push_back(item);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  int floats(const std::vector<float>& values, const std::string& type = "VEC3") {
    return accessor(values, kFloat, type);
  }

  /// One mesh of one primitive, and a node with it; returns the mesh's index.
  int mesh(const Json& primitive) {
    json["meshes"].push_back({{"primitives", {primitive}}});
    const int index = static_cast<int>(json["meshes"].size()) - 1;
    json["nodes"].push_back({{"mesh", index}});
    return index;
  }

  /// The right triangle (0,0,0), (1,0,0), (0,1,0), whose front looks along +z.
  Json triangle() { return {{"attributes", {{"POSITION", floats({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}}; }

  void save_embedded(const std::filesystem::path& path) {
    json["buffers"] = {{{"byteLength", bytes.size()},
                        {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    write_text(path, json.dump());
  }

  void save_external(const std::filesystem::path& path, const std::string& name,
                     const std::string& uri) {
    json["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}}};
    write_text(path.parent_path() / name, bytes);
    write_text(path, json.dump());
  }

  std::string glb() {
    json["buffers"] = {{{"byteLength", bytes.size()}}};
    return container();
  }

  /// `json` as it is and the bytes, in one file.
  std::string container() const {
    std::string text = json.dump(), binary = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto word = [](size_t value) {
      std::string out(4, '\0');
      const auto narrow = static_cast<uint32_t>(value);
      std::memcpy(out.data(), &narrow, 4);
      return out;
    };
    return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" +
           text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }

  void save_glb(const std::filesystem::path& path) { write_text(path, glb()); }
};

}  // namespace lte::test
