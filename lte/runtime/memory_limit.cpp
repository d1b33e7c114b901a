#include "lte/runtime/memory_limit.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string_view>
#include <utility>

#include <malloc.h>

#include "lte/base/process_memory.h"
#include "lte/base/text.h"

namespace lte::runtime {
namespace {

constexpr int64_t kMinBlock = 1024;  ///< queries: fewer at a time are slow

}  // namespace

std::string memory_text(double mb) {
  return mb < 1024 ? formatted("%.0f MiB", mb) : formatted("%.1f GiB", mb / 1024);
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

void MemoryLimit::check(const std::string& stage, std::vector<Hint> hints) const {
  const double left = left_mb();
  if (left >= 0) return;
  hints.push_back(Hint::MemoryLimit);
  throw NotEnoughMemory(concat("memory limit of ", memory_text(limit_mb_), ": ",
                               memory_text(limit_mb_ - left), " are in use after ", stage),
                        std::move(hints));
}

void MemoryLimit::check_ahead(double more_mb, const std::string& what, const std::string& hint,
                              std::vector<Hint> hints) const {
  const double left = left_mb();
  if (more_mb <= left) return;
  hints.push_back(Hint::MemoryLimit);
  throw NotEnoughMemory(concat("memory limit of ", memory_text(limit_mb_), ": ", what, " needs ",
                               memory_text(more_mb), " and ", memory_text(std::max(0.0, left)),
                               " are left: ", hint, ", or raise the limit"),
                        std::move(hints));
}

void MemoryLimit::check_encoding(const nn::ModelConfig& config, int64_t scene_points) const {
  const double left = left_mb(), need = encode_mb(config, scene_points);
  if (need <= left) return;
  const double fixed = encode_mb(config, 0), per_point = encode_mb(config, 1) - fixed;
  const auto fit = static_cast<int64_t>(std::floor((left - fixed) / per_point));
  check_ahead(need, concat("encoding ", scene_points, " scene points"),
              fit > 0 ? concat("take ", fit, " scene points or fewer")
                      : std::string("take fewer scene points or a smaller model"),
              {Hint::FewerScenePoints});
}

int64_t MemoryLimit::query_block(const nn::ModelConfig& config, int64_t queries,
                                 int64_t most) const {
  const double left = left_mb();
  if (decode_mb(config, queries, most) <= left) return most;
  const double least = decode_mb(config, queries, kMinBlock);
  check_ahead(least, concat("decoding ", queries, " queries, ", kMinBlock, " at a time,"),
              "ask for fewer at once", {Hint::FewerQueries});
  const double per_query = (decode_mb(config, queries, most) - least) /
                           static_cast<double>(std::min(queries, most) - kMinBlock);
  return kMinBlock + static_cast<int64_t>((left - least) / per_query);
}

bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::string_view(error.what()).find("can't allocate memory") != std::string_view::npos;
}

}  // namespace lte::runtime
