#include "infer/common/memory.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <new>
#include <string_view>

#include <malloc.h>

#include "lte/base/check.h"
#include "lte/base/process_memory.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

constexpr double kMiB = 1 << 20;
constexpr int64_t kLeastBlock = 1024;  ///< queries: fewer at a time are slow
// Bytes a scene point, of a channel and besides; bytes of a query of a block, and of its answer.
constexpr double kEncodeBytes = 600, kEncodeBytesPerChannel = 40;
// MiB whatever the number of points.
constexpr double kEncodeBaseMb = 20, kEncodeBaseMbPerChannel = 0.45;
constexpr double kDecodeBaseMb = 16, kDecodeBytes = 200, kAnswerBytes = 18;

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
  return mb < 1024 ? formatted("%.0f MiB", mb) : formatted("%.1f GiB", mb / 1024);
}

double encode_mb(const nn::ModelConfig& config, int64_t scene_points) {
  const double per_point =
      kEncodeBytes + kEncodeBytesPerChannel * static_cast<double>(config.channels);
  const double base =
      kEncodeBaseMb + kEncodeBaseMbPerChannel * static_cast<double>(config.channels);
  return base + 1.1 * per_point * static_cast<double>(scene_points) / kMiB;
}

double decode_mb(const nn::ModelConfig& config, int64_t queries, int64_t block) {
  const double of_block = kDecodeBytes + 16 * static_cast<double>(config.query_neighbours);
  const auto at_once = static_cast<double>(std::min(queries, block));
  return kDecodeBaseMb +
         1.1 * (kAnswerBytes * static_cast<double>(queries) + of_block * at_once) / kMiB;
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

}  // namespace lte::infer
