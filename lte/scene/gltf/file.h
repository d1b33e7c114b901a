// A glTF file on disk: its JSON, checked, and its bytes.
//
// tinygltf 2.7 reads past the end of a GLB whose last chunk is cut, trusts the ranges of buffer
// views, follows deep nesting with recursion and drops ill-typed members in silence. So files are
// opened, checked and mapped here, and tinygltf is given only JSON that has passed
// check_document(), without buffers or images to fetch.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/scene/import/scene_files.h"

namespace lte::scene::gltf {

using Json = nlohmann::json;
using Bytes = std::span<const std::byte>;

struct File {
  SceneFilePtr source;
  std::string name;  ///< its path, for messages
  Json json;
  Bytes binary;  ///< BIN chunk of a .glb, inside `source`; empty otherwise
};

/// Opens the scene's file, a .gltf or .glb (told apart by content), and parses its JSON.
/// @throws lte::Error naming the file: missing, a directory, cut, not glTF, not JSON, nested too
/// deeply.
File open_file(SceneFiles* files);

/// Checks everything that the importer relies on: types and ranges of members, indices that lead to
/// existing elements, asset version 2, required extensions among those that lte has.
/// @throws lte::Error naming file and element.
void check_document(const File& file);

/// The bytes behind `uri` and `bufferView` members: mapped files, decoded base64, or the BIN chunk.
class Buffers {
 public:
  /// Opens every buffer and checks every view's range.
  /// @throws lte::Error naming file, element and URI.
  Buffers(const File& file, SceneFiles* files);

  Bytes view(int buffer_view) const { return views_[static_cast<size_t>(buffer_view)]; }
  /// Bytes of images[index], kept alive by this object.
  Bytes image(int index);
  /// A value that buffers hold, as a message may show it: not where some lie outside the folder.
  template <typename T>
  std::string shown(const T& value) const {
    return has_outside_ ? "a value" : concat(value);
  }

 private:
  Bytes fetch(const std::string& uri, const std::string& element);

  const File& file_;
  SceneFiles* files_;
  std::vector<SceneFilePtr> opened_;
  bool has_outside_ = false;
  std::vector<std::unique_ptr<std::vector<std::byte>>> decoded_;
  std::vector<Bytes> views_;
};

}  // namespace lte::scene::gltf
