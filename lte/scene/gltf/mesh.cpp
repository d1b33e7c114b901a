// Meshes from the triangle primitives of a file.
#include <cstring>
#include <string_view>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

constexpr uint32_t kUnset = 0xffffffff;

/// Corners of triangles, three a triangle, from the vertex order of a primitive.
std::vector<std::array<uint32_t, 3>> assemble(const std::vector<uint32_t>& order, int mode) {
  std::vector<std::array<uint32_t, 3>> out;
  if (order.size() < 3) return out;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    out.resize(order.size() / 3);
    std::memcpy(out.data(), order.data(), out.size() * sizeof(out[0]));
    return out;
  }
  out.reserve(order.size() - 2);
  for (size_t i = 0; i + 2 < order.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      out.push_back({order[i + 1], order[i + 2], order[0]});
    } else {
      out.push_back({order[i], order[i + 1 + i % 2],
                     order[i + 2 - i % 2]});  // every other one is turned around
    }
  }
  return out;
}

/// The number n of an attribute TEXCOORD_n that a mesh has room for, or kNone.
int uv_set_of(const std::string& attribute) {
  constexpr std::string_view kPrefix = "TEXCOORD_";
  if (!attribute.starts_with(kPrefix) || attribute.size() != kPrefix.size() + 1) return kNone;
  const int set = attribute.back() - '0';
  return set >= 0 && set < kUvSets ? set : kNone;
}

class MeshReader {
 public:
  MeshReader(const Context& context, const std::vector<Placement>& placements, MeshTable* table)
      : context_(context), placements_(placements), table_(table) {}

  void read(const Shape& shape) {
    table_->of_shape.emplace_back();
    joints_.clear();
    if (shape.skin != kNone) joints_ = joint_matrices(context_, shape.skin, placements_);
    const tinygltf::Mesh& mesh = context_.model.meshes[static_cast<size_t>(shape.mesh)];
    ignore_unknown_extensions(mesh.extensions, "mesh", &context_.ignored);
    for (size_t k = 0; k < mesh.primitives.size(); ++k) {
      const std::string place = concat("meshes[", shape.mesh, "].primitives[", k, "]");
      std::string name = mesh.name.empty() ? concat("mesh ", shape.mesh) : mesh.name;
      if (mesh.primitives.size() > 1) name += concat("/", k);
      read_primitive(mesh.primitives[k], shape, place, std::move(name));
    }
  }

 private:
  /// Whether it draws triangles; what does not is recorded as ignored.
  bool has_triangles(const tinygltf::Primitive& primitive) {
    IgnoredFeatures& ignored = context_.ignored;
    ignore_unknown_extensions(primitive.extensions, "primitive", &ignored);
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      ignored.add(primitive.mode == TINYGLTF_MODE_POINTS ? "points" : "lines", "primitive");
      return false;
    }
    if (primitive.attributes.count("POSITION") == 0) {
      ignored.add("no POSITION", "primitive");
      return false;
    }
    return true;
  }

  void count_triangles(size_t corners, int mode, const std::string& place) {
    if (mode == TINYGLTF_MODE_TRIANGLES && corners % 3 != 0)
      context_.ignored.add("incomplete triangle", "primitive");
    triangles_ += static_cast<int64_t>(corners / (mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1));
    if (triangles_ > context_.limits.triangles)
      throw OverLimit(concat(context_.file.name, ": more than ", context_.limits.triangles,
                             " triangles, at ", place),
                      "triangles");
  }

  void read_primitive(const tinygltf::Primitive& primitive, const Shape& shape,
                      const std::string& place, std::string name) {
    if (!has_triangles(primitive)) return;
    const PrimitiveSource source(context_, primitive, place);
    const std::unique_ptr<Accessor> positions = source.attribute("POSITION");
    const size_t vertices = positions->count();
    std::vector<uint32_t> order = source.order(vertices);
    count_triangles(order.size(), primitive.mode, place);

    Mesh mesh;
    mesh.name = std::move(name);
    mesh.material = primitive.material;
    if (mesh.material < 0) {
      mesh.material = static_cast<int>(context_.model.materials.size());
      table_->needs_default_material = true;
    }
    const std::vector<uint32_t> kept = compact(vertices, &order);
    mesh.triangles = assemble(order, primitive.mode);
    if (mesh.triangles.empty()) return;
    mesh.positions = gather<Vec3>(*positions, 3, kept);
    read_attributes(source, primitive, vertices, kept, &mesh);
    if (shape.weights.empty() && shape.skin == kNone && has_normal_map(primitive))
      read_tangent_frames(source, vertices, kept, &mesh);
    const Deformation deformation{context_, primitive, source, vertices, kept};
    if (!shape.weights.empty()) apply_morph(deformation, shape.weights, &mesh);
    if (shape.skin != kNone) apply_skin(deformation, joints_, &mesh);
    table_->of_shape.back().push_back(static_cast<int>(table_->meshes.size()));
    table_->meshes.push_back(std::move(mesh));
  }

  void read_attributes(const PrimitiveSource& source, const tinygltf::Primitive& primitive,
                       size_t vertices, const std::vector<uint32_t>& kept, Mesh* mesh) const {
    for (const auto& [name, index] : primitive.attributes) {
      const int set = uv_set_of(name);
      if (set == kNone && name != "COLOR_0") continue;
      const std::unique_ptr<Accessor> accessor = source.attribute(name);
      if (set != kNone) {
        mesh->uvs[static_cast<size_t>(set)] = gather_vertices<Vec2>(*accessor, 2, vertices, kept);
      } else {
        mesh->colors = gather_vertices<Rgb>(*accessor, 3, vertices, kept);
      }
    }
  }

  bool has_normal_map(const tinygltf::Primitive& primitive) const {
    return primitive.material >= 0 &&
           context_.model.materials[static_cast<size_t>(primitive.material)].normalTexture.index >=
               0;
  }

  /// What a normal map bends. Morphed and skinned meshes go without, as their vertices have moved.
  static void read_tangent_frames(const PrimitiveSource& source, size_t vertices,
                                  const std::vector<uint32_t>& kept, Mesh* mesh) {
    if (!source.has("NORMAL")) return;
    mesh->normals = gather_vertices<Vec3>(*source.attribute("NORMAL"), 3, vertices, kept);
    if (!source.has("TANGENT")) return;
    const std::unique_ptr<Accessor> tangents = source.attribute("TANGENT");
    LTE_CHECK(tangents->components() == 4, tangents->what(), " has ", tangents->components(),
              " components, expected 4");
    const std::vector<Vec3> directions = gather_vertices<Vec3>(*tangents, 3, vertices, kept);
    for (size_t i = 0; i < directions.size(); ++i) {
      const float sign = tangents->value(kept.empty() ? i : kept[i], 3);
      mesh->tangents.push_back({directions[i], sign < 0 ? -1.0f : 1.0f});
    }
  }

  /// Many primitives may share one large vertex array: where a primitive uses fewer vertices than
  /// it has indices, keeps only those, in order of first use. Returns the kept vertices, empty for
  /// all, and renumbers `order`.
  std::vector<uint32_t> compact(size_t vertices, std::vector<uint32_t>* order) {
    std::vector<uint32_t> kept;
    if (order->size() >= vertices) return kept;
    if (new_number_.size() < vertices) new_number_.resize(vertices, kUnset);
    for (uint32_t& index : *order) {
      uint32_t& number = new_number_[index];
      if (number == kUnset) {
        number = static_cast<uint32_t>(kept.size());
        kept.push_back(index);
      }
      index = number;
    }
    for (const uint32_t index : kept) new_number_[index] = kUnset;  // ready for the next primitive
    return kept;
  }

  const Context& context_;
  const std::vector<Placement>& placements_;
  MeshTable* table_;
  std::vector<Affine> joints_;  ///< of the shape at work
  int64_t triangles_ = 0;
  std::vector<uint32_t> new_number_;
};

}  // namespace

MeshTable read_meshes(const Context& context, const std::vector<Shape>& shapes,
                      const std::vector<Placement>& placements) {
  MeshTable table;
  MeshReader reader(context, placements, &table);
  for (const Shape& shape : shapes) reader.read(shape);
  return table;
}

}  // namespace lte::scene::gltf
