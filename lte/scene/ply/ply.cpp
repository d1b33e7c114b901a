#include "lte/scene/ply/ply.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "lte/base/check.h"
#include "lte/image/tonemap.h"
#include "lte/scene/import/compressed_file.h"
#include "lte/scene/import/triangulate.h"
#include "lte/scene/ply/header.h"

namespace lte::scene::ply {
namespace {

/// The numbers behind the header, one after another.
class Body {
 public:
  Body(const std::string& name, std::string_view text, const Header& header)
      : name_(name),
        text_(text),
        place_(header.size_bytes),
        format_(header.format),
        line_(header.lines + 1) {}

  double next(Scalar type) { return format_ == Format::Ascii ? next_ascii() : next_binary(type); }

  /// The file and, in ASCII, the line, for messages.
  std::string where() const { return format_ == Format::Ascii ? concat(name_, ":", line_) : name_; }
  size_t left() const { return text_.size() - place_; }

 private:
  double next_ascii() {
    while (place_ < text_.size() && std::strchr(" \t\r\n", text_[place_]) != nullptr) {
      if (text_[place_] == '\n') ++line_;
      ++place_;
    }
    LTE_CHECK(place_ < text_.size(), where(), ": truncated, the file ends inside its data");
    double value = 0;
    if (text_[place_] == '+') ++place_;
    const auto [end, error] =
        std::from_chars(text_.data() + place_, text_.data() + text_.size(), value);
    const auto stop = static_cast<size_t>(end - text_.data());
    LTE_CHECK(error != std::errc::invalid_argument &&
                  (stop == text_.size() || std::strchr(" \t\r\n", text_[stop]) != nullptr),
              where(), ": expected a number");
    LTE_CHECK(error == std::errc(), where(), ": a number beyond the range of double");
    place_ = stop;
    return value;
  }

  template <typename T>
  double take() {
    T value;
    char bytes[sizeof(T)];
    std::memcpy(bytes, text_.data() + place_, sizeof(T));
    if ((format_ == Format::BigEndian) == (std::endian::native == std::endian::little))
      std::reverse(bytes, bytes + sizeof(T));
    std::memcpy(&value, bytes, sizeof(T));
    place_ += sizeof(T);
    return static_cast<double>(value);
  }

  double next_binary(Scalar type) {
    LTE_CHECK(left() >= ply::size_of(type), name_, ": truncated, the file ends inside its data");
    switch (type) {
      case Scalar::None:
        return 0;
      case Scalar::Int8:
        return take<int8_t>();
      case Scalar::UInt8:
        return take<uint8_t>();
      case Scalar::Int16:
        return take<int16_t>();
      case Scalar::UInt16:
        return take<uint16_t>();
      case Scalar::Int32:
        return take<int32_t>();
      case Scalar::UInt32:
        return take<uint32_t>();
      case Scalar::Float:
        return take<float>();
      case Scalar::Double:
        return take<double>();
    }
    return 0;
  }

  const std::string& name_;
  std::string_view text_;
  size_t place_;
  Format format_;
  int64_t line_;
};

/// What a vertex property fills; several spellings are in use.
enum Slot { X, Y, Z, Nx, Ny, Nz, U, V, Red, Green, Blue, kSlots };

int slot_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Slot>, 23> kNames = {{{"x", X},
                                                                         {"y", Y},
                                                                         {"z", Z},
                                                                         {"nx", Nx},
                                                                         {"ny", Ny},
                                                                         {"nz", Nz},
                                                                         {"u", U},
                                                                         {"v", V},
                                                                         {"s", U},
                                                                         {"t", V},
                                                                         {"texture_u", U},
                                                                         {"texture_v", V},
                                                                         {"texture_s", U},
                                                                         {"texture_t", V},
                                                                         {"red", Red},
                                                                         {"green", Green},
                                                                         {"blue", Blue},
                                                                         {"r", Red},
                                                                         {"g", Green},
                                                                         {"b", Blue},
                                                                         {"diffuse_red", Red},
                                                                         {"diffuse_green", Green},
                                                                         {"diffuse_blue", Blue}}};
  for (const auto& [spelling, slot] : kNames) {
    if (spelling == name) return slot;
  }
  return kSlots;
}

float to_linear(double value, Scalar type) {
  if (type == Scalar::UInt8) return image::srgb_to_linear(static_cast<float>(value / 255));
  if (type == Scalar::UInt16) return image::srgb_to_linear(static_cast<float>(value / 65535));
  return static_cast<float>(value);
}

class BodyReader {
 public:
  BodyReader(const std::string& name, std::string_view text, const LoadLimits& limits)
      : limits_(limits),
        name_(name),
        header_(read_header(name, text)),
        body_(name, text, header_) {}

  PlyMesh read() {
    bool has_vertices = false, has_faces = false;
    for (const Element& element : header_.elements) {
      if (element.name == "vertex" && !has_vertices) {
        has_vertices = true;
        read_vertices(element);
      } else if (element.name == "face" && !has_faces) {
        LTE_CHECK(has_vertices, name_, ": faces come before vertices");
        has_faces = true;
        read_faces(element);
      } else if (element.name == "tristrips") {
        LTE_CHECK(has_vertices, name_, ": triangle strips come before vertices");
        read_strips(element);
      } else {
        skip(element);
      }
    }
    LTE_CHECK(has_vertices, name_, ": no element \"vertex\"");
    LTE_CHECK(!out_.triangles.empty(), name_, ": no faces: a cloud of points is not a mesh");
    return std::move(out_);
  }

 private:
  void read_vertices(const Element& element) {
    std::array<bool, kSlots> has{};
    std::vector<std::pair<int, Scalar>> slots;
    for (const Property& property : element.properties) {
      LTE_CHECK(!property.is_list(), name_, ": the vertex property \"", property.name.substr(0, 40),
                "\" is a list");
      const int slot = slot_of(property.name);
      slots.emplace_back(slot, property.type);
      if (slot < kSlots) has[static_cast<size_t>(slot)] = true;
    }
    LTE_CHECK(has[X] && has[Y] && has[Z], name_, ": vertices without x, y and z");
    LTE_CHECK(element.count < int64_t{UINT32_MAX}, name_, ": too many vertices: ", element.count);
    const bool normals = has[Nx] && has[Ny] && has[Nz], uvs = has[U] && has[V],
               colors = has[Red] && has[Green] && has[Blue];
    const auto count = static_cast<size_t>(element.count);
    out_.positions.reserve(count);
    if (normals) out_.normals.reserve(count);
    if (uvs) out_.uvs.reserve(count);
    if (colors) out_.colors.reserve(count);
    std::array<float, kSlots + 1> v{};
    for (size_t i = 0; i < count; ++i) {
      for (const auto& [slot, type] : slots) {
        const double value = body_.next(type);
        v[static_cast<size_t>(slot)] =
            slot >= Red && slot < kSlots ? to_linear(value, type) : static_cast<float>(value);
      }
      const bool finite = std::all_of(v.begin(), v.begin() + kSlots,
                                      [](float value) { return std::isfinite(value); });
      LTE_CHECK(finite, body_.where(), ": vertex ", i, " is not finite");
      out_.positions.push_back({v[X], v[Y], v[Z]});
      if (normals) out_.normals.push_back({v[Nx], v[Ny], v[Nz]});
      if (uvs) out_.uvs.push_back({v[U], v[V]});
      if (colors) out_.colors.push_back({v[Red], v[Green], v[Blue]});
    }
  }

  size_t list_length(const Property& property, int64_t index, const std::string& element) {
    const double length = body_.next(property.count_type);
    LTE_CHECK(length >= 0 && length == std::floor(length), body_.where(), ": ", element, " ", index,
              ": a list of ", length, " entries");
    // Each entry takes a byte at least.
    LTE_CHECK(length <= static_cast<double>(body_.left()), body_.where(), ": ", element, " ", index,
              ": truncated, a list of ", length, " entries in the last ", body_.left(), " bytes");
    return static_cast<size_t>(length);
  }

  void read_faces(const Element& element) {
    const auto is_index = [](const Property& p) {
      return p.is_list() && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    LTE_CHECK(element.count == 0 ||
                  std::any_of(element.properties.begin(), element.properties.end(), is_index),
              name_, ": faces without a list \"vertex_indices\" or \"vertex_index\"");
    out_.faces = element.count;
    if (element.count > limits_.triangles)
      throw OverLimit(concat(name_, ": ", element.count, " faces exceed the limit of ",
                             limits_.triangles, " triangles"),
                      "triangles", element.count);
    out_.triangles.reserve(static_cast<size_t>(element.count));
    std::vector<uint32_t> corners;
    for (int64_t face = 0; face < element.count; ++face) {
      for (const Property& property : element.properties) {
        if (is_index(property)) {
          read_corners(property, face, &corners);
        } else {
          skip(property, face, element.name);
        }
      }
      add_face(face, corners);
    }
  }

  /// Stanford's strips: indices one after another, −1 between two strips.
  void read_strips(const Element& element) {
    for (int64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (property.is_list() && property.name == "vertex_indices") {
          read_strip(property, i);
        } else {
          skip(property, i, element.name);
        }
      }
    }
  }

  void read_strip(const Property& property, int64_t list) {
    const size_t length = list_length(property, list, "triangle strip");
    std::array<uint32_t, 2> last{};
    int64_t place = 0;  // in its strip
    for (size_t k = 0; k < length; ++k) {
      const double index = body_.next(property.type);
      if (index == -1) {
        place = 0;
        continue;
      }
      const uint32_t corner = checked_index(index, "triangle strip", list);
      if (place >= 2) {
        const bool turned = place % 2 == 1;
        add_face(out_.faces++, {last[turned ? 1 : 0], last[turned ? 0 : 1], corner});
      }
      last = {last[1], corner};
      ++place;
    }
  }

  uint32_t checked_index(double index, const char* what, int64_t number) const {
    LTE_CHECK(index >= 0 && index < static_cast<double>(out_.positions.size()) &&
                  index == std::floor(index),
              body_.where(), ": ", what, " ", number, ": index ", index, ", but there are ",
              out_.positions.size(), " vertices");
    return static_cast<uint32_t>(index);
  }

  void read_corners(const Property& property, int64_t face, std::vector<uint32_t>* corners) {
    const size_t length = list_length(property, face, "face");
    corners->resize(length);
    for (uint32_t& corner : *corners)
      corner = checked_index(body_.next(property.type), "face", face);
  }

  void add_face(int64_t face, const std::vector<uint32_t>& corners) {
    if (corners.size() < 3) {
      ++out_.dropped_faces;
      return;
    }
    triangulate_polygon(out_.positions, corners, &out_.triangles);
    if (static_cast<int64_t>(out_.triangles.size()) > limits_.triangles)
      throw OverLimit(concat(body_.where(), ": face ", face, " is beyond the limit of ",
                             limits_.triangles, " triangles"),
                      "triangles");
  }

  void skip(const Property& property, int64_t index, const std::string& element) {
    const size_t values = property.is_list() ? list_length(property, index, element) : 1;
    for (size_t k = 0; k < values; ++k) body_.next(property.type);
  }

  void skip(const Element& element) {
    for (int64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) skip(property, i, element.name);
    }
  }

  const LoadLimits& limits_;
  const std::string& name_;
  Header header_;
  Body body_;
  PlyMesh out_;
};

}  // namespace

PlyMesh read_ply(const SceneFilePtr& file, LoadBudget* budget) {
  return read_discreetly(*file, "PLY mesh", [&] {
    const CompressedFile text(file, budget);
    return BodyReader(file->name(), text.text(), budget->limits()).read();
  });
}

}  // namespace lte::scene::ply
