// Names of the values of enum classes: in YAML, in the metadata of model files, on command lines.
//
// A mode of a configuration is an enum class beside a table of names, which is found by its type:
//   enum class Stem { Conv5, Conv3 };
//   constexpr EnumNames<Stem, 2> enum_names(Stem) {
//     return {{{Stem::Conv5, "conv5"}, {Stem::Conv3, "conv3"}}};
//   }
// Then enum_name(Stem::Conv3) is "conv3", parse_enum<Stem>("stem", "conv3") gives the value back,
// and Config::read(key, &stem) reads it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "lte/base/check.h"

namespace lte {

template <typename T>
concept EnumClass = std::is_enum_v<T>;

template <typename Enum>
struct EnumName {
  Enum value;
  const char* name;
};

/// Every value once. A message lists the names in this order.
template <typename Enum, size_t N>
using EnumNames = std::array<EnumName<Enum>, N>;

/// Position of `text` in `names`.
///
/// @param key  what the text was given for: a key or a flag
/// @throws lte::Error "KEY: expected conv5 | conv3, got "conv4"; did you mean "conv5"?"
size_t find_name(const std::string& key, const std::string& text,
                 const std::vector<std::string>& names);

template <typename Enum, size_t N>
const char* enum_name(Enum value, const EnumNames<Enum, N>& names) {
  for (const EnumName<Enum>& entry : names) {
    if (entry.value == value) return entry.name;
  }
  throw Error("an enum class has no name for the value " + std::to_string(static_cast<int>(value)));
}

template <typename Enum>
const char* enum_name(Enum value) {
  return enum_name(value, enum_names(Enum{}));
}

/// @throws lte::Error as find_name()
template <typename Enum, size_t N>
Enum parse_enum(const std::string& key, const std::string& text, const EnumNames<Enum, N>& names) {
  std::vector<std::string> known;
  for (const EnumName<Enum>& entry : names) known.push_back(entry.name);
  return names[find_name(key, text, known)].value;
}

template <typename Enum>
Enum parse_enum(const std::string& key, const std::string& text) {
  return parse_enum(key, text, enum_names(Enum{}));
}

}  // namespace lte
