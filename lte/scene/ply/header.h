// The header of a PLY file: which elements follow, and of which scalars they are made.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lte::scene::ply {

enum class Format { Ascii, LittleEndian, BigEndian };
enum class Scalar { None, Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

size_t size_of(Scalar type);
inline bool is_integer(Scalar type) { return type != Scalar::Float && type != Scalar::Double; }

struct Property {
  std::string name;
  Scalar type = Scalar::None;
  Scalar count_type = Scalar::None;  ///< None but for lists
  bool is_list() const { return count_type != Scalar::None; }
};

struct Element {
  std::string name;
  int64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::Ascii;
  std::vector<Element> elements;
  size_t size_bytes = 0;  ///< where the elements begin
  int lines = 0;
};

/// @param name  of the file, for messages
/// @throws lte::Error naming file and line, also for a count of elements that the bytes behind the
/// header cannot hold.
Header read_header(const std::string& name, std::string_view text);

}  // namespace lte::scene::ply
