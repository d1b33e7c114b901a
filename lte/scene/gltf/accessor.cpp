// Accessors: typed, strided, normalized or sparse elements of buffer views.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

template <typename T>
T read(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

template <typename T>
float read_integer(const std::byte* at, bool normalized) {
  const auto value = static_cast<float>(read<T>(at));
  return normalized ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f)
                    : value;
}

uint32_t read_index(const std::byte* at, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return read<uint8_t>(at);
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? read<uint16_t>(at) : read<uint32_t>(at);
}

size_t component_size(int type) {
  return static_cast<size_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type)));
}

/// `view` from `offset` on, after a check that `count` elements of `size` bytes, `stride` apart,
/// lie in it. Written so that no sum or product can wrap, whatever the file says.
Bytes elements(Bytes view, uint64_t offset, uint64_t count, uint64_t stride, uint64_t size,
               const std::string& what) {
  if (count == 0) return {};
  LTE_CHECK(offset <= view.size() && size <= view.size() - offset &&
                count - 1 <= (view.size() - offset - size) / stride,
            what, ": ", count, " elements of ", size, " bytes, ", stride, " apart from byte ",
            offset, " on, do not fit into a buffer view of ", view.size(), " bytes");
  return view.subspan(offset);
}

}  // namespace

const tinygltf::Accessor& Accessor::set_types(const Context& context, int index, bool matrix) {
  const tinygltf::Accessor& accessor = context.model.accessors[static_cast<size_t>(index)];
  type_ = accessor.componentType;
  components_ = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  if (matrix) {
    LTE_CHECK(accessor.type == TINYGLTF_TYPE_MAT4 && type_ == TINYGLTF_COMPONENT_TYPE_FLOAT, what_,
              " must hold MAT4 of floats");
  } else {
    LTE_CHECK(components_ <= 4 && accessor.type != TINYGLTF_TYPE_MAT2, what_,
              ": a matrix cannot be an attribute");
  }
  normalized_ = accessor.normalized;
  stride_ = component_size(type_) * static_cast<size_t>(components_);
  return accessor;
}

Accessor::Accessor(const Context& context, int index, const std::string& what,
                   std::vector<std::byte> bytes, size_t count)
    : what_(concat(context.file.name, ": ", what)), count_(count), copy_(std::move(bytes)) {
  set_types(context, index, /*matrix=*/false);
  data_ = copy_.data();
}

Accessor::Accessor(const Context& context, int index, const std::string& what,
                   const AccessorUse& use)
    : what_(concat(context.file.name, ": ", what)) {
  const tinygltf::Accessor& accessor = set_types(context, index, use.matrix);
  count_ = accessor.count;
  const size_t size = stride_;
  Bytes dense;
  if (accessor.bufferView >= 0) {
    const tinygltf::BufferView& view =
        context.model.bufferViews[static_cast<size_t>(accessor.bufferView)];
    if (view.byteStride > 0) stride_ = view.byteStride;
    LTE_CHECK(stride_ >= size, what_, ": byteStride ", stride_, " is less than an element's ", size,
              " bytes");
    dense = elements(context.buffers.view(accessor.bufferView), accessor.byteOffset, count_,
                     stride_, size, what_);
  } else {
    LTE_CHECK(count_ <= use.zeros, what_, ": an accessor without bufferView has ", count_,
              " elements, more than the ", use.zeros, " that are allowed");
  }
  data_ = dense.data();
  if (accessor.bufferView < 0 || accessor.sparse.isSparse) apply_sparse(context, accessor, dense);
}

void Accessor::apply_sparse(const Context& context, const tinygltf::Accessor& accessor,
                            Bytes dense) {
  const size_t size = component_size(type_) * static_cast<size_t>(components_);
  copy_.resize(count_ * size);
  for (size_t i = 0; i < count_ && !dense.empty(); ++i) {
    std::memcpy(copy_.data() + i * size, dense.data() + i * stride_, size);
  }
  stride_ = size;
  data_ = copy_.data();
  if (!accessor.sparse.isSparse) return;

  const auto& sparse = accessor.sparse;
  LTE_CHECK(sparse.count >= 0 && static_cast<uint64_t>(sparse.count) <= count_, what_, ": ",
            sparse.count, " sparse values for ", count_, " elements");
  const auto count = static_cast<uint64_t>(sparse.count);
  const size_t index_size = component_size(sparse.indices.componentType);
  const Bytes indices = elements(context.buffers.view(sparse.indices.bufferView),
                                 static_cast<uint64_t>(sparse.indices.byteOffset), count,
                                 index_size, index_size, what_ + " (sparse indices)");
  const Bytes values = elements(context.buffers.view(sparse.values.bufferView),
                                static_cast<uint64_t>(sparse.values.byteOffset), count, size, size,
                                what_ + " (sparse values)");
  for (uint64_t i = 0; i < count; ++i) {
    const uint32_t at = read_index(indices.data() + i * index_size, sparse.indices.componentType);
    LTE_CHECK(at < count_, what_, ": sparse index ", i, " is ", context.buffers.shown(at),
              ", but there are ", count_, " elements");
    std::memcpy(copy_.data() + at * size, values.data() + i * size, size);
  }
}

float Accessor::value(size_t i, int c) const {
  const std::byte* at = element(i) + static_cast<size_t>(c) * component_size(type_);
  switch (type_) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return read<float>(at);
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return read_integer<int8_t>(at, normalized_);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read_integer<uint8_t>(at, normalized_);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return read_integer<int16_t>(at, normalized_);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read_integer<uint16_t>(at, normalized_);
    default:
      return read_integer<uint32_t>(at, normalized_);
  }
}

std::vector<uint32_t> Accessor::read_indices() const {
  const bool is_unsigned = type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                           type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  LTE_CHECK(is_unsigned && components_ == 1, what_, ": indices must be unsigned scalars");
  std::vector<uint32_t> out(count_);
  if (type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT && stride_ == sizeof(uint32_t)) {
    if (count_ > 0) std::memcpy(out.data(), data_, count_ * sizeof(uint32_t));
    return out;
  }
  for (size_t i = 0; i < count_; ++i) out[i] = read_index(element(i), type_);
  return out;
}

template <typename T>
std::vector<T> gather(const Accessor& accessor, int components, const std::vector<uint32_t>& kept) {
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
      for (int c = 0; c < components; ++c) {
        values[c] = accessor.value(source, c);
        finite &= std::isfinite(values[c]);
      }
    }
    LTE_CHECK(finite, accessor.what(), ": vertex ", source, " is not finite");
  }
  return out;
}

template std::vector<Vec2> gather(const Accessor&, int, const std::vector<uint32_t>&);
template std::vector<Vec3> gather(const Accessor&, int, const std::vector<uint32_t>&);

}  // namespace lte::scene::gltf
