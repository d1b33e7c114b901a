#include "lte/scene/import/limits.h"

#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/text.h"

namespace lte::scene {
namespace {

constexpr double kMax = 1e18;

constexpr struct {
  std::string_view name;
  int64_t LoadLimits::*value;
} kLimits[] = {{"triangles", &LoadLimits::triangles},    {"pixels", &LoadLimits::texture_pixels},
               {"pictures", &LoadLimits::picture_bytes}, {"inflated", &LoadLimits::inflated_bytes},
               {"text", &LoadLimits::text_bytes},        {"includes", &LoadLimits::includes}};

/// "", "k", "MB", "GiB" as a factor.
std::optional<double> factor_of(std::string_view unit) {
  if (unit.ends_with('B') || unit.ends_with('b')) unit.remove_suffix(1);
  const bool binary = unit.ends_with('i');
  if (binary) unit.remove_suffix(1);
  if (unit.empty()) return binary ? std::nullopt : std::optional<double>(1);
  constexpr std::string_view kPrefixes = "kmgt";
  const size_t power = kPrefixes.find(lower_case(unit));
  if (unit.size() != 1 || power == kPrefixes.npos) return std::nullopt;
  double factor = 1;
  for (size_t i = 0; i <= power; ++i) factor *= binary ? 1024 : 1000;
  return factor;
}

int64_t parse_value(const std::string& part, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::optional<double> factor =
      factor_of(text.substr(static_cast<size_t>(end - text.data())));
  LTE_CHECK(error == std::errc() && factor && value >= 0 && value * *factor <= kMax, "limit \"",
            part, "\": expected a number behind the =, such as 500000, 500MB or 4GB");
  return static_cast<int64_t>(value * *factor);
}

void set_limit(const std::string& part, LoadLimits* limits) {
  std::vector<std::string> names;
  std::string list;
  const size_t equals = part.find('=');
  const std::string name = part.substr(0, equals);
  for (const auto& limit : kLimits) {
    if (limit.name == name && equals != part.npos) {
      limits->*limit.value = parse_value(part, std::string_view(part).substr(equals + 1));
      return;
    }
    names.emplace_back(limit.name);
    list += concat(list.empty() ? "" : ", ", limit.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw Error(concat("limit \"", part, "\": expected NAME=VALUE with a name of ", list,
                     nearest.empty() ? "" : concat("; did you mean ", nearest, "?")));
}

}  // namespace

LoadLimits parse_limits(const std::string& text) {
  LoadLimits limits;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    set_limit(text.substr(begin, end - begin), &limits);
    begin = end + 1;
  }
  return limits;
}

}  // namespace lte::scene
