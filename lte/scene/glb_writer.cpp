#include "lte/scene/glb_writer.h"

#include <array>
#include <cstring>
#include <string>

#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::scene {
namespace {

// "glTF", "JSON" and "BIN" as little-endian words.
constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kFloat = 5126, kUnsignedInt = 5125;

/// Chunks and views begin at multiples of four bytes.
size_t padded(size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

nlohmann::json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

int GlbWriter::add_bytes(const void* bytes, size_t size) {
  binary_.resize(padded(binary_.size()));
  const size_t offset = binary_.size();
  binary_.resize(offset + size);
  if (size > 0) std::memcpy(binary_.data() + offset, bytes, size);
  json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
  return static_cast<int>(json_["bufferViews"].size()) - 1;
}

int GlbWriter::add_accessor(const void* data, size_t count, size_t element_size, int component_type,
                            const char* type) {
  const int view = add_bytes(data, count * element_size);
  json_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  return static_cast<int>(json_["accessors"].size()) - 1;
}

int GlbWriter::add_positions(const std::vector<Vec3>& values) {
  const int accessor = add_vectors(values);
  Bounds box;  // which the format demands for positions
  for (const Vec3& p : values) box.extend(p);
  json_["accessors"].back()["min"] = vector_json(box.low);
  json_["accessors"].back()["max"] = vector_json(box.high);
  return accessor;
}

int GlbWriter::add_vectors(const std::vector<Vec3>& values) {
  return add_accessor(values.data(), values.size(), sizeof(Vec3), kFloat, "VEC3");
}

int GlbWriter::add_vectors(const std::vector<Vec2>& values) {
  return add_accessor(values.data(), values.size(), sizeof(Vec2), kFloat, "VEC2");
}

int GlbWriter::add_vectors(const std::vector<Tangent>& values) {
  return add_accessor(values.data(), values.size(), sizeof(Tangent), kFloat, "VEC4");
}

int GlbWriter::add_indices(const std::vector<std::array<uint32_t, 3>>& triangles) {
  return add_accessor(triangles.data(), 3 * triangles.size(), sizeof(uint32_t), kUnsignedInt,
                      "SCALAR");
}

void GlbWriter::write(const std::filesystem::path& path) {
  binary_.resize(padded(binary_.size()));
  json_["buffers"] = {{{"byteLength", binary_.size()}}};
  std::string text = json_.dump();
  text.resize(padded(text.size()), ' ');
  const size_t length = 12 + 8 + text.size() + 8 + binary_.size();
  LTE_CHECK(length <= UINT32_MAX, path.string(), ": the scene takes ", length,
            " bytes, a .glb holds at most ", UINT32_MAX);

  const auto word = [](size_t value) { return static_cast<uint32_t>(value); };
  const std::array<uint32_t, 5> header{kMagic, 2, word(length), word(text.size()), kJsonChunk};
  const std::array<uint32_t, 2> binary_header{word(binary_.size()), kBinChunk};
  AtomicFile file(path);
  file.write(header.data(), sizeof(header));
  file.write(text);
  file.write(binary_header.data(), sizeof(binary_header));
  file.write(binary_.data(), binary_.size());
  file.commit();
}

}  // namespace lte::scene
