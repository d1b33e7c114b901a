// Triangle primitives to meshes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf_import.h"

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

class MeshReader {
 public:
  MeshReader(const Context& context, MeshTable* table) : context_(context), table_(table) {}

  void read(int gltf_mesh) {
    const tinygltf::Mesh& mesh = context_.model.meshes[static_cast<size_t>(gltf_mesh)];
    note_extensions(mesh.extensions, "mesh", &context_.notes);
    for (size_t k = 0; k < mesh.primitives.size(); ++k) {
      const std::string place = concat("meshes[", gltf_mesh, "].primitives[", k, "]");
      std::string name = mesh.name.empty() ? concat("mesh ", gltf_mesh) : mesh.name;
      if (mesh.primitives.size() > 1) name += concat("/", k);
      read_primitive(mesh.primitives[k], gltf_mesh, place, std::move(name));
    }
  }

 private:
  void read_primitive(const tinygltf::Primitive& primitive, int gltf_mesh, const std::string& place,
                      std::string name) {
    Notes& notes = context_.notes;
    note_extensions(primitive.extensions, "primitive", &notes);
    if (!primitive.targets.empty()) notes.add("morph targets", "primitive");
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      notes.add(primitive.mode == TINYGLTF_MODE_POINTS ? "points" : "lines", "primitive");
      return;
    }
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) {
      notes.add("no POSITION", "primitive");
      return;
    }
    const Accessor positions(context_, position->second, place + ".POSITION");
    std::vector<uint32_t> order = read_order(primitive, positions, place);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)
      notes.add("incomplete triangle", "primitive");
    triangles_ +=
        static_cast<int64_t>(order.size() / (primitive.mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1));
    LTE_CHECK(triangles_ <= context_.limits.triangles, context_.file.name, ": more than ",
              context_.limits.triangles, " triangles, at ", place);

    Mesh mesh;
    mesh.name = std::move(name);
    mesh.material = primitive.material;
    if (mesh.material < 0) {
      mesh.material = static_cast<int>(context_.model.materials.size());
      table_->needs_default_material = true;
    }
    const std::vector<uint32_t> kept = compact(positions.count(), &order);
    mesh.triangles = assemble(order, primitive.mode);
    if (mesh.triangles.empty()) return;
    mesh.positions = gather<Vec3>(positions, 3, kept);
    read_attributes(primitive, positions.count(), kept, place, &mesh);
    table_->of_gltf[static_cast<size_t>(gltf_mesh)].push_back(
        static_cast<int>(table_->meshes.size()));
    table_->meshes.push_back(std::move(mesh));
  }

  void read_attributes(const tinygltf::Primitive& primitive, size_t vertices,
                       const std::vector<uint32_t>& kept, const std::string& place, Mesh* mesh) {
    for (const auto& [name, index] : primitive.attributes) {
      const bool uv = name == "TEXCOORD_0" || name == "TEXCOORD_1";
      if (!uv && name != "COLOR_0") continue;
      const Accessor accessor(context_, index, place + "." + name);
      LTE_CHECK(accessor.count() == vertices, accessor.what(), " has ", accessor.count(),
                " elements, but there are ", vertices, " vertices");
      if (uv) {
        mesh->uvs[name.back() == '0' ? 0 : 1] = gather<Vec2>(accessor, 2, kept);
      } else {
        mesh->colors = gather<Rgb>(accessor, 3, kept);
      }
    }
  }

  /// Vertex numbers in drawing order, all of them checked.
  std::vector<uint32_t> read_order(const tinygltf::Primitive& primitive, const Accessor& positions,
                                   const std::string& place) const {
    LTE_CHECK(positions.count() < kUnset, context_.file.name, ": ", place, " has ",
              positions.count(), " vertices");
    if (primitive.indices < 0) {
      std::vector<uint32_t> order(positions.count());
      std::iota(order.begin(), order.end(), 0u);
      return order;
    }
    const Accessor indices(context_, primitive.indices, place + ".indices");
    std::vector<uint32_t> order = indices.read_indices();
    const auto bad = std::find_if(order.begin(), order.end(),
                                  [&](uint32_t i) { return i >= positions.count(); });
    LTE_CHECK(bad == order.end(), context_.file.name, ": ", place, ": index ", bad - order.begin(),
              " is ", *bad, ", but there are ", positions.count(), " vertices");
    return order;
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

  /// The first `components` floats of the kept elements.
  /// @throws lte::Error naming the first element that is not finite.
  template <typename T>
  std::vector<T> gather(const Accessor& accessor, int components,
                        const std::vector<uint32_t>& kept) const {
    static_assert(std::is_trivially_copyable_v<T>);
    LTE_CHECK(accessor.components() >= components, accessor.what(), " has ", accessor.components(),
              " components, expected ", components);
    std::vector<T> out(kept.empty() ? accessor.count() : kept.size());
    const bool whole = kept.empty() && accessor.component_type() == TINYGLTF_COMPONENT_TYPE_FLOAT;
    for (size_t i = 0; i < out.size(); ++i) {
      const size_t source = kept.empty() ? i : kept[i];
      float* values = &out[i].x;
      bool finite = true;
      if (whole) {
        std::memcpy(values, accessor.element(source), sizeof(T));
        for (int c = 0; c < components; ++c) finite &= std::isfinite(values[c]);
      } else {
        for (int c = 0; c < components; ++c)
          finite &= std::isfinite(values[c] = accessor.value(source, c));
      }
      LTE_CHECK(finite, accessor.what(), ": vertex ", source, " is not finite");
    }
    return out;
  }

  const Context& context_;
  MeshTable* table_;
  int64_t triangles_ = 0;
  std::vector<uint32_t> new_number_;
};

}  // namespace

MeshTable read_meshes(const Context& context, const std::vector<bool>& used) {
  MeshTable table;
  table.of_gltf.resize(context.model.meshes.size());
  MeshReader reader(context, &table);
  for (size_t i = 0; i < used.size(); ++i) {
    if (used[i]) reader.read(static_cast<int>(i));
  }
  return table;
}

}  // namespace lte::scene::gltf
