// Vertices of a primitive, compressed or not.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"
#include "lte/scene/gltf/draco.h"

namespace lte::scene::gltf {

/// KHR_draco_mesh_compression of one primitive.
class PrimitiveSource::Compressed {
 public:
  Compressed(const Context& context, const tinygltf::Primitive& primitive,
             const tinygltf::Value& extension, const std::string& place)
      : where_(concat(context.file.name, ": ", place, ".KHR_draco_mesh_compression")),
        ids_(extension.Get("attributes")),
        mesh_(context.buffers.view(extension.Get("bufferView").GetNumberAsInt()),
              promised(context, primitive), &context.budget, where_) {}

  bool has(const std::string& attribute) const { return ids_.Has(attribute); }

  std::unique_ptr<Accessor> attribute(const Context& context, const std::string& name, int index,
                                      const std::string& place) const {
    const tinygltf::Accessor& accessor = context.model.accessors[static_cast<size_t>(index)];
    const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
    std::vector<std::byte> bytes = mesh_.attribute(ids_.Get(name).GetNumberAsInt(), name,
                                                   accessor.componentType, components, where_);
    return std::make_unique<Accessor>(context, index, concat(place, ".", name), std::move(bytes),
                                      mesh_.points());
  }

  std::vector<uint32_t> order() const { return mesh_.order(); }

 private:
  /// What the accessors promise, so that a few bytes cannot unfold into gigabytes.
  DracoLimits promised(const Context& context, const tinygltf::Primitive& primitive) const {
    const auto count = [&](int index) {
      return index < 0 ? uint64_t{0} : context.model.accessors[static_cast<size_t>(index)].count;
    };
    LTE_CHECK(primitive.indices >= 0, where_, ": the primitive has no indices");
    LTE_CHECK(primitive.mode == TINYGLTF_MODE_TRIANGLES, where_, ": mode ", primitive.mode,
              ", only triangle lists are understood");
    const uint64_t triangles =
        std::min(count(primitive.indices) / 3, static_cast<uint64_t>(context.limits.triangles));
    int64_t bytes_per_point = 0;
    for (const auto& [name, index] : primitive.attributes) {
      const tinygltf::Accessor& accessor = context.model.accessors[static_cast<size_t>(index)];
      bytes_per_point +=
          int64_t{tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type))} *
          tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
    }
    return {triangles, count(primitive.attributes.at("POSITION")), bytes_per_point};
  }

  std::string where_;
  const tinygltf::Value& ids_;
  DracoMesh mesh_;
};

PrimitiveSource::PrimitiveSource(const Context& context, const tinygltf::Primitive& primitive,
                                 std::string place)
    : context_(context), primitive_(primitive), place_(std::move(place)) {
  const auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
  if (draco == primitive.extensions.end() || !draco->second.Has("bufferView")) return;
  compressed_ = std::make_unique<Compressed>(context, primitive, draco->second, place_);
}

PrimitiveSource::~PrimitiveSource() = default;

bool PrimitiveSource::has(const std::string& attribute) const {
  return primitive_.attributes.count(attribute) > 0;
}

std::unique_ptr<Accessor> PrimitiveSource::attribute(const std::string& attribute) const {
  const int index = primitive_.attributes.at(attribute);
  if (compressed_ && compressed_->has(attribute))
    return compressed_->attribute(context_, attribute, index, place_);
  return std::make_unique<Accessor>(context_, index, concat(place_, ".", attribute));
}

std::vector<uint32_t> PrimitiveSource::order(size_t vertices) const {
  LTE_CHECK(vertices < std::numeric_limits<uint32_t>::max(), context_.file.name, ": ", place_,
            " has ", vertices, " vertices");
  std::vector<uint32_t> order;
  if (compressed_) {
    order = compressed_->order();
  } else if (primitive_.indices < 0) {
    order.resize(vertices);
    std::iota(order.begin(), order.end(), 0u);
    return order;
  } else {
    order = Accessor(context_, primitive_.indices, place_ + ".indices").read_indices();
  }
  const auto bad =
      std::find_if(order.begin(), order.end(), [&](uint32_t i) { return i >= vertices; });
  LTE_CHECK(bad == order.end(), context_.file.name, ": ", place_, ": index ", bad - order.begin(),
            " is ", context_.buffers.shown(*bad), ", but there are ", vertices, " vertices");
  return order;
}

}  // namespace lte::scene::gltf
