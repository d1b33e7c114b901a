#include "lte/data/incident_field.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::data {
namespace {

constexpr const char* kPrefix = "incident_";
constexpr const char* kSamples = "incident_samples";

/// Calls `io(name, shape, array)` for every tensor: the one list that reading and writing share.
template <typename Io, typename Field>
void visit(Io& io, int64_t G, int64_t P, int64_t B, Field& field) {
  io("position", {P, 3}, field.position);
  io("normal", {P, 3}, field.normal);
  io("tangent", {P, 3}, field.tangent);
  io("albedo", {P, 3}, field.albedo);
  io("metallic", {P}, field.metallic);
  io("roughness", {P}, field.roughness);
  io("scale", {P}, field.scale);
  io("direct", {G, P, B, B, 3}, field.direct);
  io("indirect", {G, P, B, B, 3}, field.indirect);
  io("direction", {B, B, 3}, field.direction);
  io("pdf", {B, B}, field.pdf);
}

template <typename T>
struct Element {
  using Type = T;
};
template <>
struct Element<Vec3> {
  using Type = float;
};

struct Writer {
  SafetensorsWriter* writer;
  template <typename T>
  void operator()(const char* name, std::vector<int64_t> shape, const std::vector<T>& values) {
    writer->add(concat(kPrefix, name), std::move(shape),
                reinterpret_cast<const typename Element<T>::Type*>(values.data()));
  }
};

struct Reader {
  const SafetensorsFile& file;
  template <typename T>
  void operator()(const char* name, const std::vector<int64_t>& shape, std::vector<T>& out) {
    const auto values = file.values<typename Element<T>::Type>(concat(kPrefix, name), shape);
    const auto* first = reinterpret_cast<const T*>(values.data());
    out.assign(first, first + values.size_bytes() / sizeof(T));
  }
};

}  // namespace

size_t IncidentField::size_bytes() const {
  return (position.size() + normal.size() + tangent.size() + albedo.size() + direction.size()) *
             sizeof(Vec3) +
         (metallic.size() + roughness.size() + scale.size() + pdf.size()) * sizeof(float) +
         (direct.size() + indirect.size()) * sizeof(Half);
}

float half_scale(float largest) {
  LTE_CHECK(std::isfinite(largest) && largest >= 0,
            "radiance must be finite and not negative, got ", largest);
  if (largest == 0) return 1;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0f, std::max(exponent - 15, -126));
}

void add_incident(SafetensorsWriter* writer, int64_t light_groups, const IncidentField& field) {
  writer->set_metadata(kSamples, std::to_string(field.samples));
  Writer io{writer};
  visit(io, light_groups, field.points(), field.bins, field);
}

IncidentField read_incident(const SafetensorsFile& file, int64_t light_groups) {
  IncidentField field;
  const auto found = file.metadata().find(kSamples);
  if (found == file.metadata().end()) return field;
  const std::string& text = found->second;
  LTE_CHECK(!text.empty() && text.size() <= 9 &&
                text.find_first_not_of("0123456789") == std::string::npos,
            file.path().string(), ": metadata ", kSamples,
            ": expected a non-negative integer below 10^9, got \"", text, "\"");
  field.samples = std::stoll(text);
  const TensorView& pdf = file.at(concat(kPrefix, "pdf"));
  LTE_CHECK(pdf.shape.size() == 2 && pdf.shape[0] == pdf.shape[1] && pdf.shape[0] >= 2 &&
                pdf.shape[0] <= 1024 && pdf.shape[0] % 2 == 0,
            file.path().string(), ": tensor ", kPrefix,
            "pdf: expected a shape [bins, bins], even, of 2 to 1024");
  field.bins = static_cast<int>(pdf.shape[0]);
  const TensorView& position = file.at(concat(kPrefix, "position"));
  LTE_CHECK(!position.shape.empty(), file.path().string(), ": tensor ", kPrefix,
            "position: expected a shape [points, 3]");
  Reader io{file};
  visit(io, light_groups, position.shape[0], field.bins, field);
  return field;
}

}  // namespace lte::data
