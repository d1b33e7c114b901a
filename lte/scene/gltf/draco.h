// Draco, the compression of KHR_draco_mesh_compression, through Google's libdraco.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lte/scene/gltf/file.h"

namespace lte::scene::gltf {

/// What a compressed mesh may unfold into.
struct DracoLimits {
  uint64_t triangles = 0, points = 0;
  int64_t bytes_per_point = 0;  ///< of its attributes, as the accessors have them
};

class DracoMesh {
 public:
  /// @param where  file and element, for messages
  /// @throws lte::Error if the bytes are no mesh, are damaged, or hold more than `limits`;
  /// OverLimit for more than the budget has left. The header's counts are looked at before anything
  /// is allocated for them.
  DracoMesh(Bytes bytes, const DracoLimits& limits, LoadBudget* budget, const std::string& where);
  ~DracoMesh();

  size_t points() const;
  /// Point numbers, three a triangle.
  std::vector<uint32_t> order() const;
  /// An attribute's values, tightly, one element a point.
  /// @param id              Draco's unique id of it
  /// @param component_type  of glTF, 5120 to 5126
  /// @throws lte::Error if there is no such attribute, or a value does not fit the type.
  std::vector<std::byte> attribute(int id, const std::string& name, int component_type,
                                   int components, const std::string& where) const;

 private:
  struct Decoded;  // libdraco's headers stay out of everyone else's sight
  std::unique_ptr<Decoded> decoded_;
};

}  // namespace lte::scene::gltf
