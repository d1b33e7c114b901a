// Numbers in texts: of command lines, environment variables, metadata and file names.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace lte {

/// The number that `text` is as a whole: no white space, no plus. Nothing if it is none, or none
/// that a Number can hold. Floating point reads "inf" and "nan", too.
template <typename Number>
std::optional<Number> to_number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

/// The text behind its plus, if it begins with one: to_number() takes none.
inline std::string_view without_plus(std::string_view text) {
  return text.substr(text.starts_with('+') ? 1 : 0);
}

/// The N numbers that `text` is, such as 640x480 or 2/4. Nothing if it is anything else.
template <typename Number, size_t N>
std::optional<std::array<Number, N>> to_numbers(std::string_view text, char separator) {
  std::array<Number, N> values{};
  for (size_t i = 0; i < N; ++i) {
    const size_t end = i + 1 < N ? text.find(separator) : text.size();
    if (end == text.npos) return std::nullopt;
    const std::optional<Number> value = to_number<Number>(text.substr(0, end));
    if (!value) return std::nullopt;
    values[i] = *value;
    if (i + 1 < N) text.remove_prefix(end + 1);
  }
  return values;
}

}  // namespace lte
