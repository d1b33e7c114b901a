#include "lte/scene/gltf/draco.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop

#include "lte/base/check.h"

namespace lte::scene::gltf {
namespace {

constexpr uint16_t kHasMetadata = 0x8000;
/// The best that Draco does is a small fraction of a bit a triangle, on flat regular grids.
constexpr uint64_t kTrianglesPerByte = 1024;
constexpr int64_t kTriangleBytes = 3 * sizeof(uint32_t);

struct Counts {
  uint32_t triangles = 0, points = 0;
};

/// Reads a count as every version since 2.0 (which glTF asks for) writes it.
bool read_count(const draco::DracoHeader& header, draco::DecoderBuffer* buffer, uint32_t* count) {
  const bool is_varint = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING ||
                         header.version_major > 2 || header.version_minor >= 2;
  return is_varint ? draco::DecodeVarint(count, buffer) : buffer->Decode(count);
}

/// The counts that stand before the compressed data (Draco bitstream, sections 2 and 3).
bool read_counts(Bytes bytes, Counts* counts) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  if (header.encoder_type != draco::TRIANGULAR_MESH || header.version_major < 2) return false;
  if ((header.flags & kHasMetadata) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return false;
  }
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    return read_count(header, &buffer, &counts->triangles) &&
           read_count(header, &buffer, &counts->points);
  }
  // Edgebreaker: a byte for the kind of traversal, before 2.2 the vertices that splits add,
  // vertices (fewer than the points, as those on seams are several points), triangles.
  uint8_t traversal = 0;
  uint32_t added = 0;
  const bool has_added = header.version_major == 2 && header.version_minor < 2;
  return buffer.Decode(&traversal) && (!has_added || read_count(header, &buffer, &added)) &&
         read_count(header, &buffer, &counts->points) &&
         read_count(header, &buffer, &counts->triangles);
}

template <typename T>
std::vector<std::byte> convert(const draco::PointAttribute& attribute, uint32_t points,
                               int components, const std::string& what) {
  const auto width = static_cast<size_t>(components);
  std::vector<std::byte> out(points * width * sizeof(T));
  auto* values = reinterpret_cast<T*>(out.data());
  for (uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    LTE_CHECK(attribute.ConvertValue<T>(at, static_cast<int8_t>(components), values + i * width),
              what, ": point ", i, " has no value, or one that the accessor's type cannot hold");
  }
  return out;
}

}  // namespace

struct DracoMesh::Decoded {
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(Bytes bytes, const DracoLimits& limits, LoadBudget* budget,
                     const std::string& where) {
  Counts counts;
  LTE_CHECK(read_counts(bytes, &counts), where, ": not a Draco mesh");
  LTE_CHECK(counts.triangles <= limits.triangles && counts.points <= limits.points, where,
            ": holds ", counts.triangles, " triangles and ", counts.points,
            " points, but its accessors have room for ", limits.triangles, " and ", limits.points);
  LTE_CHECK(counts.triangles <= kTrianglesPerByte * bytes.size() &&
                counts.points <= 3 * kTrianglesPerByte * bytes.size(),
            where, ": ", counts.triangles, " triangles and ", counts.points,
            " points cannot be in ", bytes.size(), " bytes");
  budget->add_inflated(counts.triangles * kTriangleBytes + counts.points * limits.bytes_per_point,
                       where);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  LTE_CHECK(decoded.ok(), where, ": damaged Draco data: ", decoded.status().error_msg_string());
  decoded_ = std::make_unique<Decoded>(Decoded{std::move(decoded).value()});
  LTE_CHECK(decoded_->mesh->num_faces() <= limits.triangles && points() <= limits.points, where,
            ": unfolds into ", decoded_->mesh->num_faces(), " triangles and ", points(),
            " points, but its accessors have room for ", limits.triangles, " and ", limits.points);
}

DracoMesh::~DracoMesh() = default;

size_t DracoMesh::points() const { return decoded_->mesh->num_points(); }

std::vector<uint32_t> DracoMesh::order() const {
  const draco::Mesh& mesh = *decoded_->mesh;
  std::vector<uint32_t> out;
  out.reserve(size_t{mesh.num_faces()} * 3);
  for (uint32_t i = 0; i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i)))
      out.push_back(corner.value());
  }
  return out;
}

std::vector<std::byte> DracoMesh::attribute(int id, const std::string& name, int component_type,
                                            int components, const std::string& where) const {
  const draco::PointAttribute* found =
      decoded_->mesh->GetAttributeByUniqueId(static_cast<uint32_t>(id));
  const std::string what = concat(where, ".attributes.", name);
  LTE_CHECK(found != nullptr, what, " is ", id, ", but the data hold no such attribute");
  LTE_CHECK(found->num_components() == components, what, " has ",
            static_cast<int>(found->num_components()), " components, but its accessor ",
            components);
  const bool floats =
      found->data_type() == draco::DT_FLOAT32 || found->data_type() == draco::DT_FLOAT64;
  LTE_CHECK(!floats || component_type == 5126, what,
            " holds floats, but its accessor integers");  // which libdraco would cut off
  const auto points = static_cast<uint32_t>(this->points());
  LTE_CHECK(found->is_mapping_identity() || found->indices_map_size() >= points, what,
            " does not cover the points");
  switch (component_type) {
    case 5120:
      return convert<int8_t>(*found, points, components, what);
    case 5121:
      return convert<uint8_t>(*found, points, components, what);
    case 5122:
      return convert<int16_t>(*found, points, components, what);
    case 5123:
      return convert<uint16_t>(*found, points, components, what);
    case 5125:
      return convert<uint32_t>(*found, points, components, what);
    default:
      return convert<float>(*found, points, components, what);
  }
}

}  // namespace lte::scene::gltf
