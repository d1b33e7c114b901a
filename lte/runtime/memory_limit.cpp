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

constexpr double kMiB = 1 << 20;
constexpr int64_t kLeastBlock = 1024;  ///< queries: fewer at a time are slow
// Bytes a scene point, of a channel and besides; bytes of a query of a block, and of its answer.
constexpr double kEncodeBytes = 600, kEncodeBytesPerChannel = 40;
// MiB whatever the number of points.
constexpr double kEncodeBaseMb = 20, kEncodeBaseMbPerChannel = 0.45;
constexpr double kDecodeBaseMb = 16, kDecodeBytes = 200, kAnswerBytes = 18;

}  // namespace

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

void MemoryLimit::check(const std::string& stage, std::vector<Remedy> remedies) const {
  const double left = left_mb();
  if (left >= 0) return;
  remedies.push_back(Remedy::MemoryLimit);
  throw NotEnoughMemory(concat("memory limit of ", memory_text(limit_mb_), ": ",
                               memory_text(limit_mb_ - left), " are in use after ", stage),
                        std::move(remedies));
}

void MemoryLimit::check_ahead(double more_mb, const std::string& what, const std::string& remedy,
                              std::vector<Remedy> remedies) const {
  const double left = left_mb();
  if (more_mb <= left) return;
  remedies.push_back(Remedy::MemoryLimit);
  throw NotEnoughMemory(concat("memory limit of ", memory_text(limit_mb_), ": ", what, " needs ",
                               memory_text(more_mb), " and ", memory_text(std::max(0.0, left)),
                               " are left: ", remedy, ", or raise the limit"),
                        std::move(remedies));
}

void MemoryLimit::check_encoding(const nn::ModelConfig& config, int64_t scene_points) const {
  const double left = left_mb(), need = encode_mb(config, scene_points);
  if (need <= left) return;
  const double fixed = encode_mb(config, 0), per_point = encode_mb(config, 1) - fixed;
  const auto fit = static_cast<int64_t>(std::floor((left - fixed) / per_point));
  check_ahead(need, concat("encoding ", scene_points, " scene points"),
              fit > 0 ? concat("take ", fit, " scene points or fewer")
                      : std::string("take fewer scene points or a smaller model"),
              {Remedy::FewerScenePoints});
}

int64_t MemoryLimit::query_block(const nn::ModelConfig& config, int64_t queries,
                                 int64_t most) const {
  const double left = left_mb();
  if (decode_mb(config, queries, most) <= left) return most;
  const double least = decode_mb(config, queries, kLeastBlock);
  check_ahead(least, concat("decoding ", queries, " queries, ", kLeastBlock, " at a time,"),
              "ask for fewer at once", {Remedy::FewerQueries});
  const double per_query = (decode_mb(config, queries, most) - least) /
                           static_cast<double>(std::min(queries, most) - kLeastBlock);
  return kLeastBlock + static_cast<int64_t>((left - least) / per_query);
}

bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::string_view(error.what()).find("can't allocate memory") != std::string_view::npos;
}

}  // namespace lte::runtime
