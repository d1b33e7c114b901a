#include "infer/tool/memory.h"

#include <charconv>
#include <cmath>

#include "lte/base/check.h"

namespace lte::infer {

double parse_memory(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  const std::string unit(at, end);
  double factor = 0;
  if (unit.empty() || unit == "M" || unit == "m") factor = 1;
  if (unit == "K" || unit == "k") factor = 1.0 / 1024;
  if (unit == "G" || unit == "g") factor = 1024;
  LTE_CHECK(error == std::errc() && factor > 0 && value >= 0 && std::isfinite(value),
            "--max-memory \"", text, "\": expected a size such as 500M or 2G");
  return value * factor;
}

}  // namespace lte::infer
