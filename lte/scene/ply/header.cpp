#include "lte/scene/ply/header.h"

#include <array>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/to_number.h"

namespace lte::scene::ply {
namespace {

constexpr size_t kMaxHeader = 1 << 20;
constexpr size_t kMaxProperties = 4096;

constexpr std::array<std::pair<std::string_view, Scalar>, 16> kScalars = {
    {{"char", Scalar::Int8},
     {"uchar", Scalar::UInt8},
     {"short", Scalar::Int16},
     {"ushort", Scalar::UInt16},
     {"int", Scalar::Int32},
     {"uint", Scalar::UInt32},
     {"float", Scalar::Float},
     {"double", Scalar::Double},
     {"int8", Scalar::Int8},
     {"uint8", Scalar::UInt8},
     {"int16", Scalar::Int16},
     {"uint16", Scalar::UInt16},
     {"int32", Scalar::Int32},
     {"uint32", Scalar::UInt32},
     {"float32", Scalar::Float},
     {"float64", Scalar::Double}}};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t place = 0; (place = line.find_first_not_of(" \t\r", place)) != line.npos;) {
    const size_t end = std::min(line.find_first_of(" \t\r", place), line.size());
    words.push_back(line.substr(place, end - place));
    place = end;
  }
  return words;
}

/// "Created" begins a line that Blender 2.4 writes without "comment" before it.
bool is_comment(std::string_view word) {
  return word == "comment" || word == "obj_info" || word == "Created";
}

class HeaderReader {
 public:
  HeaderReader(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  Header read() {
    LTE_CHECK(next_line() && split(line_) == std::vector<std::string_view>{"ply"}, name_,
              ": not a PLY file (its first line is not \"ply\")");
    bool has_format = false;
    while (true) {
      LTE_CHECK(next_line(), name_, ":", out_.lines, ": the PLY header has no \"end_header\"");
      const std::vector<std::string_view> words = split(line_);
      if (words.empty() || is_comment(words[0])) continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        read_format(words);
        has_format = true;
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        fail("unknown line in the PLY header, expected format, element, property or end_header");
      }
    }
    LTE_CHECK(has_format, name_, ":", out_.lines, ": the PLY header has no \"format\" line");
    out_.size_bytes = place_;
    check_counts();
    return std::move(out_);
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(const Args&... args) const {
    throw Error(concat(name_, ":", out_.lines, ": ", args...));
  }

  bool next_line() {
    if (place_ >= text_.size() || place_ > kMaxHeader) return false;
    // Some writers end lines with a carriage return alone.
    const size_t end = text_.find_first_of("\r\n", place_);
    if (end == text_.npos) return false;
    line_ = text_.substr(place_, end - place_);
    place_ = end + (text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n' ? 2 : 1);
    ++out_.lines;
    return true;
  }

  void read_format(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || words[2] != "1.0") fail("expected \"format ENCODING 1.0\"");
    if (words[1] == "ascii") {
      out_.format = Format::Ascii;
    } else if (words[1] == "binary_little_endian") {
      out_.format = Format::LittleEndian;
    } else if (words[1] == "binary_big_endian") {
      out_.format = Format::BigEndian;
    } else {
      fail("unknown PLY encoding, expected ascii, binary_little_endian or binary_big_endian");
    }
  }

  void read_element(const std::vector<std::string_view>& words) {
    Element element;
    if (words.size() != 3) fail("expected \"element NAME COUNT\"");
    element.name = words[1];
    const auto count = to_number<decltype(element.count)>(words[2]);
    if (!count || *count < 0) fail("the count of an element must be a whole number from 0 on");
    element.count = *count;
    if (out_.elements.size() >= kMaxProperties) fail("too many elements");
    out_.elements.push_back(std::move(element));
  }

  Scalar scalar(std::string_view word) const {
    for (const auto& [scalar_name, type] : kScalars) {
      if (scalar_name == word) return type;
    }
    fail(
        "unknown type of a property, expected char, uchar, short, ushort, int, uint, float or "
        "double");
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (out_.elements.empty()) fail("a property before the first element");
    Property property;
    if (words.size() == 5 && words[1] == "list") {
      property.count_type = scalar(words[2]);
      if (!is_integer(property.count_type)) fail("the length of a list must be an integer");
      property.type = scalar(words[3]);
    } else if (words.size() == 3) {
      property.type = scalar(words[1]);
    } else {
      fail("expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
    }
    property.name = words.back();
    std::vector<Property>& list = out_.elements.back().properties;
    if (list.size() >= kMaxProperties) fail("too many properties");
    list.push_back(std::move(property));
  }

  /// Every element takes room: an empty list its length, a number in ASCII a digit and a separator.
  void check_counts() const {
    size_t left = text_.size() - place_;
    for (const Element& element : out_.elements) {
      if (element.count == 0) continue;
      LTE_CHECK(!element.properties.empty(), name_, ": the element \"", element.name.substr(0, 40),
                "\" has no properties");
      size_t least = 0;
      for (const Property& property : element.properties) {
        least += out_.format == Format::Ascii
                     ? 2
                     : size_of(property.is_list() ? property.count_type : property.type);
      }
      const size_t slack = out_.format == Format::Ascii ? 1 : 0;  // no separator at the very end
      LTE_CHECK(static_cast<size_t>(element.count) <= (left + slack) / least, name_,
                ": truncated, the header promises ", element.count, " of \"",
                element.name.substr(0, 40), "\", more than the ", left,
                " bytes behind it can hold");
      left -= std::min(left, static_cast<size_t>(element.count) * least);
    }
  }

  const std::string& name_;
  std::string_view text_, line_;
  size_t place_ = 0;
  Header out_;
};

}  // namespace

size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::None:
      return 0;
    case Scalar::Int8:
    case Scalar::UInt8:
      return 1;
    case Scalar::Int16:
    case Scalar::UInt16:
      return 2;
    case Scalar::Int32:
    case Scalar::UInt32:
    case Scalar::Float:
      return 4;
    case Scalar::Double:
      return 8;
  }
  return 0;
}

Header read_header(const std::string& name, std::string_view text) {
  return HeaderReader(name, text).read();
}

}  // namespace lte::scene::ply
