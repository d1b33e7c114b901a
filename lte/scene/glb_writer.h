// Puts a binary glTF together: arrays go into the BIN chunk, their views and accessors into the
// JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// The three numbers.
nlohmann::json vector_json(const Vec3& v);

class GlbWriter {
 public:
  /// The document; the caller adds to it, this class fills bufferViews, accessors and buffers.
  nlohmann::json& json() { return json_; }

  /// Each returns the index of the new accessor, or of the buffer view for bytes.
  int add_positions(const std::vector<Vec3>& values);
  int add_vectors(const std::vector<Vec3>& values);
  int add_vectors(const std::vector<Vec2>& values);
  int add_vectors(const std::vector<Tangent>& values);
  int add_indices(const std::vector<std::array<uint32_t, 3>>& triangles);
  int add_bytes(const void* bytes, size_t size);

  /// @throws lte::Error if the file would exceed the 4 GiB that the format allows, or cannot be
  /// written.
  void write(const std::filesystem::path& path);

 private:
  int add_accessor(const void* data, size_t count, size_t element_size, int component_type,
                   const char* type);

  nlohmann::json json_;
  std::vector<char> binary_;
};

}  // namespace lte::scene
