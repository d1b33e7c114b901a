// The parts of the glTF importer, and what they share.
#pragma once

#include <compare>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tiny_gltf.h>

#include "lte/base/check.h"
#include "lte/scene/gltf/file.h"
#include "lte/scene/import/ignored_features.h"
#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::gltf {

/// What every part reads, and the record of ignored features that it adds to.
struct Context {
  const File& file;
  const tinygltf::Model& model;
  const Buffers& buffers;
  const LoadLimits& limits;
  LoadBudget& budget;
  IgnoredFeatures& ignored;
};

/// The document as tinygltf understands it, without buffers, images and animations, which it never
/// sees.
/// @note Leaves only "images" in file->json: embedded buffers may be most of a document, and are
/// decoded by now.
tinygltf::Model parse_model(File* file);

/// Records the extensions of an element that lte does not understand.
void ignore_unknown_extensions(const tinygltf::ExtensionMap& extensions, const std::string& unit,
                               IgnoredFeatures* ignored);

/// What a use of an accessor allows.
struct AccessorUse {
  bool matrix = false;  ///< MAT4 is wanted; otherwise matrices are refused
  /// Elements that may be zeros without a byte in the file. No file needs many, and a count costs a
  /// hostile one nothing.
  uint64_t zeros = uint64_t{1} << 20;
};

/// Elements of an accessor where they lie in the file, or, for sparse or compressed ones, in a
/// copy.
class Accessor {
 public:
  /// @param what  the attribute that uses it, for messages: "meshes[0].primitives[1].POSITION"
  /// @throws lte::Error if elements lie outside the buffer view, or zeros are asked for beyond
  /// reason.
  Accessor(const Context& context, int index, const std::string& what, const AccessorUse& use = {});
  /// The accessor's types over `count` elements that lie tightly in `bytes` instead.
  Accessor(const Context& context, int index, const std::string& what, std::vector<std::byte> bytes,
           size_t count);
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
  const tinygltf::Accessor& set_types(const Context& context, int index, bool matrix);
  void apply_sparse(const Context& context, const tinygltf::Accessor& accessor, Bytes dense);

  std::string what_;
  size_t count_ = 0, stride_ = 0;
  int components_ = 0, type_ = 0;
  bool normalized_ = false;
  const std::byte* data_ = nullptr;
  std::vector<std::byte> copy_;
};

/// The first `components` floats of the elements that `kept` names, or of all if it is empty.
/// @throws lte::Error naming the first element that is not finite.
template <typename T>
std::vector<T> gather(const Accessor& accessor, int components, const std::vector<uint32_t>& kept);

/// Gathers an attribute that must have one element for each of `vertices`.
template <typename T>
std::vector<T> gather_vertices(const Accessor& accessor, int components, size_t vertices,
                               const std::vector<uint32_t>& kept) {
  LTE_CHECK(accessor.count() == vertices, accessor.what(), " has ", accessor.count(),
            " elements, but there are ", vertices, " vertices");
  return gather<T>(accessor, components, kept);
}

/// The source of a primitive's vertices: its accessors, or KHR_draco_mesh_compression.
class PrimitiveSource {
 public:
  /// @throws lte::Error if the compressed data are broken or larger than the accessors say.
  PrimitiveSource(const Context& context, const tinygltf::Primitive& primitive, std::string place);
  ~PrimitiveSource();

  bool has(const std::string& attribute) const;
  /// @param attribute  one that has() knows
  std::unique_ptr<Accessor> attribute(const std::string& attribute) const;
  /// Vertex numbers in drawing order, all of them below `vertices`.
  std::vector<uint32_t> order(size_t vertices) const;
  const std::string& place() const { return place_; }

 private:
  class Compressed;
  const Context& context_;
  const tinygltf::Primitive& primitive_;
  std::string place_;
  std::unique_ptr<Compressed> compressed_;
};

/// A mesh of the file in the pose that a node gives it at rest; nodes that agree share one.
struct Shape {
  int mesh = 0;
  std::vector<double> weights;  ///< of morph targets; empty if none has an effect
  int skin = kNone;             ///< its vertices are then in the world already
  auto operator<=>(const Shape&) const = default;
};

/// A node that is part of the scene.
struct Placement {
  int node = 0;
  Affine to_world;
  int shape = kNone;     ///< index into the shapes that find_shapes() returns
  bool skinned = false;  ///< that shape is in the world already
};

/// What the nodes show, in the order of their meshes in the file; sets Placement::shape and
/// ::skinned.
std::vector<Shape> find_shapes(const Context& context, std::vector<Placement>* placements);

/// The rest pose of a skin: joint to world times inverse bind matrix, one a joint.
/// @throws lte::Error naming a joint that is not in the scene, or a matrix that is not affine.
std::vector<Affine> joint_matrices(const Context& context, int skin,
                                   const std::vector<Placement>& placements);

/// One primitive whose mesh is under construction.
struct Deformation {
  const Context& context;
  const tinygltf::Primitive& primitive;
  const PrimitiveSource& source;
  size_t vertices = 0;                ///< in the file
  const std::vector<uint32_t>& kept;  ///< those in the mesh; empty for all
};

/// Adds the morph targets, weighted, to positions, texture coordinates and colors.
void apply_morph(const Deformation& deformation, const std::vector<double>& weights, Mesh* mesh);
/// Brings the positions into the world. Triangles that the joints mirror are turned around.
void apply_skin(const Deformation& deformation, const std::vector<Affine>& joints, Mesh* mesh);

/// Meshes of the file, one a triangle primitive, in the order of the file.
struct MeshTable {
  std::vector<Mesh> meshes;
  std::vector<std::vector<int>> of_shape;  ///< indices into `meshes` for each shape
  /// Whether some mesh has `material` == number of materials of the file.
  bool needs_default_material = false;
};

MeshTable read_meshes(const Context& context, const std::vector<Shape>& shapes,
                      const std::vector<Placement>& placements);

/// All materials of the file. TextureRef::texture is an index into the file's images; see
/// read_textures().
std::vector<Material> read_materials(const Context& context);

/// Decodes the images that materials refer to, in parallel, and turns their references into indices
/// of the result.
std::vector<std::shared_ptr<const Texture>> read_textures(const Context& context, Buffers* buffers,
                                                          std::vector<Material>* materials);

/// Nodes of the default scene, depth first in the order of the file.
/// @throws lte::Error for a cycle, a node with two parents, excessive depth or a transform that is
/// not finite and affine.
std::vector<Placement> place_nodes(const Context& context);

/// The transforms with which a node places its mesh: one, or those that EXT_mesh_gpu_instancing
/// lists.
/// @throws lte::Error if the lists differ in length or hold what is not finite.
std::vector<Affine> instance_transforms(const Context& context, const Placement& placement);

/// Adds the perspective cameras and the punctual lights of the nodes to the scene.
/// @throws lte::Error for an intensity that is not finite.
void add_lights_and_cameras(const Context& context, const std::vector<Placement>& placements,
                            Scene* scene);

}  // namespace lte::scene::gltf
