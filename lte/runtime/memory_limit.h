// How much memory a run may add to what its scene and model take once they are loaded, what
// encoding and decoding need, and how a lack of it is reported.
#pragma once

#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "lte/base/check.h"
#include "lte/nn/config.h"
#include "lte/nn/inference_memory.h"
#include "lte/runtime/limit_error.h"

namespace lte::runtime {

/// "1.5 GiB" or "210 MiB".
std::string memory_text(double mb);

using nn::decode_mb;
using nn::encode_mb;

/// The limit, counted from what was resident when it was made.
class MemoryLimit {
 public:
  MemoryLimit() = default;  ///< none
  /// @param limit_mb  0 for none
  explicit MemoryLimit(double limit_mb);

  double left_mb() const;
  /// @param stage     what has been done
  /// @param hints  what would have needed less
  /// @throws NotEnoughMemory if more has been added than allowed.
  void check(const std::string& stage, std::vector<Hint> hints = {}) const;
  /// @param what      needs the memory
  /// @param hint    what to do, in words; `hints` tells it to programs
  /// @throws NotEnoughMemory if there is no room for `more_mb`.
  void check_ahead(double more_mb, const std::string& what, const std::string& hint,
                   std::vector<Hint> hints = {}) const;
  /// @throws NotEnoughMemory if so many points cannot be encoded, naming how many could.
  void check_encoding(const nn::ModelConfig& config, int64_t scene_points) const;
  /// The largest block of queries that fits, at most `most`.
  /// @throws NotEnoughMemory if not even a small one does.
  int64_t query_block(const nn::ModelConfig& config, int64_t queries, int64_t most) const;

 private:
  double limit_mb_ = std::numeric_limits<double>::infinity();
  double base_mb_ = 0;
};

/// Queries that decoding takes at a time where nothing limits it.
inline constexpr int64_t kQueryBlock = int64_t{1} << 17;

/// std::bad_alloc, or LibTorch's error of the same meaning.
bool is_out_of_memory(const std::exception& error);

/// What to say where memory runs out.
struct MemoryNeed {
  std::string doing;  ///< "encoding 20000 scene points"
  double mb = 0;      ///< above the model
  std::string hint;   ///< what to do
  std::vector<Hint> hints = {};
};

/// Runs `body`. @throws NotEnoughMemory that says `need` where memory runs out.
template <typename Body>
auto explain_out_of_memory(const MemoryNeed& need, const Body& body) {
  try {
    return body();
  } catch (const std::exception& error) {
    if (!is_out_of_memory(error)) throw;
    throw NotEnoughMemory(concat("out of memory while ", need.doing, ", which needs about ",
                                 memory_text(need.mb), " above the model: ", need.hint),
                          need.hints);
  }
}

}  // namespace lte::runtime
