#include "infer/common/memory.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <new>
#include <string_view>

#include <malloc.h>

#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::infer {
namespace {

constexpr int64_t kLeastBlock = 1024;  ///< queries: fewer at a time are slow

}  // namespace

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

std::string memory_text(double mb) {
  char text[32];
  std::snprintf(text, sizeof text, mb < 1024 ? "%.0f MiB" : "%.1f GiB", mb < 1024 ? mb : mb / 1024);
  return text;
}

MemoryLimit::MemoryLimit(double limit_mb) {
  if (limit_mb <= 0) return;
  ::malloc_trim(0);  // what earlier stages gave back does not count
  limit_mb_ = limit_mb;
  base_mb_ = current_rss_mb();
}

double MemoryLimit::left_mb() const {
  return std::isinf(limit_mb_) ? limit_mb_ : limit_mb_ + base_mb_ - current_rss_mb();
}

void MemoryLimit::check(const std::string& stage) const {
  LTE_CHECK(left_mb() >= 0, "--max-memory ", memory_text(limit_mb_), ": ",
            memory_text(limit_mb_ - left_mb()), " are in use after ", stage);
}

void MemoryLimit::check_ahead(double more_mb, const std::string& what,
                              const std::string& remedy) const {
  const double left = left_mb();
  LTE_CHECK(more_mb <= left, "--max-memory ", memory_text(limit_mb_), ": ", what, " needs ",
            memory_text(more_mb), " and ", memory_text(std::max(0.0, left)), " are left: ", remedy,
            ", or raise the limit");
}

void MemoryLimit::check_encoding(const nn::ModelConfig& config, int64_t scene_points) const {
  const double left = left_mb(), need = encode_mb(config, scene_points);
  if (need <= left) return;
  const double fixed = encode_mb(config, 0), per_point = encode_mb(config, 1) - fixed;
  const auto fit = static_cast<int64_t>(std::floor((left - fixed) / per_point));
  check_ahead(need, concat("encoding ", scene_points, " scene points"),
              fit > 0 ? concat("take ", fit, " scene points or fewer (--scene-points)")
                      : std::string("take fewer scene points or a smaller model"));
}

int64_t MemoryLimit::query_block(const nn::ModelConfig& config, int64_t queries,
                                 int64_t most) const {
  const double left = left_mb();
  if (decode_mb(config, queries, most) <= left) return most;
  const double least = decode_mb(config, queries, kLeastBlock);
  check_ahead(least, concat("decoding ", queries, " queries, ", kLeastBlock, " at a time,"),
              "ask for fewer at once (a smaller picture)");
  const double per_query = (decode_mb(config, queries, most) - least) /
                           static_cast<double>(std::min(queries, most) - kLeastBlock);
  return kLeastBlock + static_cast<int64_t>((left - least) / per_query);
}

bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::string_view(error.what()).find("can't allocate memory") != std::string_view::npos;
}

void reset_peak_rss() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

}  // namespace lte::infer
