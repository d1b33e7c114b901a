// The parts of the glTF importer, and what they share.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tiny_gltf.h>

#include "lte/scene/gltf_file.h"
#include "lte/scene/load.h"
#include "lte/scene/scene.h"

namespace lte::scene::gltf {

/// Counts of what the importer leaves out, for Scene::ignored.
class Notes {
 public:
  /// @param what  e.g. "extension KHR_materials_sheen"
  /// @param unit  what is counted, singular, e.g. "material"
  void add(const std::string& what, const std::string& unit, int64_t count = 1) {
    counts_[{what, unit}] += count;
  }
  std::vector<std::string> lines() const;

 private:
  std::map<std::pair<std::string, std::string>, int64_t> counts_;
};

/// What every part reads, and the notes it adds to.
struct Context {
  const File& file;
  const tinygltf::Model& model;
  const Buffers& buffers;
  const LoadLimits& limits;
  Notes& notes;
};

/// The document as tinygltf understands it, without buffers, images, animations and skins, which it
/// never sees.
/// @note Leaves only "images" in file->json: embedded buffers may be most of a document, and are
/// decoded by now.
tinygltf::Model parse_model(File* file);

/// Notes the extensions of an element that lte does not understand.
void note_extensions(const tinygltf::ExtensionMap& extensions, const std::string& unit,
                     Notes* notes);

/// Elements of an accessor where they lie in the file, or, for sparse ones, in a copy.
class Accessor {
 public:
  /// @param what  the attribute that uses it, for messages: "meshes[0].primitives[1].POSITION"
  /// @throws lte::Error if elements lie outside the buffer view, or zeros are asked for beyond
  /// reason.
  Accessor(const Context& context, int index, const std::string& what);
  Accessor(const Accessor&) = delete;
  Accessor& operator=(const Accessor&) = delete;

  size_t count() const { return count_; }
  int components() const { return components_; }
  /// File and attribute, for messages.
  const std::string& what() const { return what_; }
  /// One of the component types of glTF, 5120 to 5126.
  int component_type() const { return type_; }
  const std::byte* element(size_t i) const { return data_ + i * stride_; }

  /// Component c of element i as a float; integers are mapped to [0, 1] or [-1, 1] if they are
  /// normalized.
  float value(size_t i, int c) const;

  /// @throws lte::Error unless it holds unsigned scalars.
  std::vector<uint32_t> read_indices() const;

 private:
  void apply_sparse(const Context& context, const tinygltf::Accessor& accessor, Bytes dense);

  std::string what_;
  size_t count_ = 0, stride_ = 0;
  int components_ = 0, type_ = 0;
  bool normalized_ = false;
  const std::byte* data_ = nullptr;
  std::vector<std::byte> copy_;
};

/// Meshes of the file, one a triangle primitive, in the order of the file.
struct MeshTable {
  std::vector<Mesh> meshes;
  std::vector<std::vector<int>>
      of_gltf;  ///< indices into `meshes` for each mesh of the file; empty if unused
  bool needs_default_material =
      false;  ///< some mesh has `material` == number of materials of the file
};

/// Converts the meshes that `used` marks.
MeshTable read_meshes(const Context& context, const std::vector<bool>& used);

/// All materials of the file. TextureRef::texture is an index into the file's images; see
/// read_textures().
std::vector<Material> read_materials(const Context& context);

/// Decodes the images that materials refer to, in parallel, and turns their references into indices
/// of the result.
std::vector<std::shared_ptr<const Texture>> read_textures(const Context& context, Buffers* buffers,
                                                          std::vector<Material>* materials);

/// A node that is part of the scene.
struct Placement {
  int node = 0;
  Affine to_world;
};

/// Nodes of the default scene, depth first in the order of the file.
/// @throws lte::Error for a cycle, a node with two parents, excessive depth or a transform that is
/// not finite and affine.
std::vector<Placement> place_nodes(const Context& context);

Camera make_camera(const tinygltf::Camera& camera, const tinygltf::Node& node,
                   const Affine& to_world);
PunctualLight make_light(const tinygltf::Light& light, const tinygltf::Node& node,
                         const Affine& to_world);

}  // namespace lte::scene::gltf
