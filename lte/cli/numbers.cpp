#include "lte/cli/numbers.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "lte/base/check.h"

namespace lte {
namespace {

/// The text as a message shows it: a line of digits is nothing to read.
std::string shown(const std::string& text) {
  constexpr size_t kMax = 40;
  return concat("\"", text.size() <= kMax ? text : text.substr(0, kMax - 3) + "...", "\"");
}

/// The number of a text that is one and nothing else; NaN otherwise.
double number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' ? std::numeric_limits<double>::quiet_NaN() : value;
}

template <typename T>
std::string check_integer(std::string* text) {
  std::string_view digits = *text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  T value = 0;
  const char *begin = digits.data(), *end = begin + digits.size();
  const auto [at, error] = std::from_chars(begin, end, value);
  const bool minus = digits.starts_with('-');
  if (error == std::errc::result_out_of_range || (minus && std::is_unsigned_v<T>)) {
    return concat("expected a whole number from ", std::numeric_limits<T>::min(), " to ",
                  std::numeric_limits<T>::max(), ", got ", shown(*text));
  }
  if (error != std::errc() || at != end)
    return concat("expected a whole number, got ", shown(*text));
  *text = std::to_string(value);  // CLI11 takes digits behind a zero for octal ones
  return "";
}

std::string check_float(std::string* text) {
  const double value = number_in(*text);
  if (std::isfinite(value) && std::abs(value) <= std::numeric_limits<float>::max()) return "";
  char* end = nullptr;
  std::strtod(text->c_str(), &end);
  if (text->empty() || *end != '\0') return concat("expected a number, got ", shown(*text));
  return concat("expected a finite number that float32 can hold, got ", shown(*text));
}

CLI::Validator above(const char* name, const char* expected, bool zero) {
  return CLI::Validator(
      [expected, zero](std::string& text) {
        const double value = number_in(text);
        const bool good = value > 0 || (zero && value == 0);
        return good ? std::string() : concat("expected ", expected, ", got ", shown(text));
      },
      name);
}

}  // namespace

void guard_numbers(CLI::App* app) {
  for (CLI::Option* option : app->get_options()) {
    const std::string type = option->get_type_name();
    std::string (*check)(std::string*) = type.starts_with("UINT")    ? check_integer<uint64_t>
                                         : type.starts_with("INT")   ? check_integer<int64_t>
                                         : type.starts_with("FLOAT") ? check_float
                                                                     : nullptr;
    // transform() puts a check before those that are there.
    if (check != nullptr)
      option->transform(CLI::Validator([check](std::string& text) { return check(&text); }, ""));
  }
  for (CLI::App* command : app->get_subcommands({})) guard_numbers(command);
}

CLI::Validator positive_number() { return above("POSITIVE", "a number above 0", false); }
CLI::Validator non_negative_number() { return above("NONNEGATIVE", "0 or a number above", true); }

double parse_time(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  const std::string unit(at, end);
  const bool known = error == std::errc() && (unit == "s" || unit == "ms");
  LTE_CHECK(known && std::isfinite(value) && value > 0, "\"", text,
            "\": expected a time such as 0.5s or 200ms");
  return unit == "s" ? value : value / 1000;
}

CLI::Validator a_time() {
  return CLI::Validator(
      [](const std::string& text) {
        try {
          parse_time(text);
          return std::string();
        } catch (const Error& error) {
          return std::string(error.what());
        }
      },
      "TIME");
}

}  // namespace lte
