// --max-memory: how much a run may add to what its scene and model take once they are loaded, what
// encoding and decoding need, and how a lack of it is reported.
#pragma once

#include <cstdint>
#include <exception>
#include <limits>
#include <string>

#include "lte/base/check.h"
#include "lte/nn/config.h"
#include "lte/nn/cost.h"

namespace lte::infer {

/// "500M", "2G", "1.5g", "800K" in binary units, or a plain number of MiB -> MiB; 0 for no limit.
/// @throws lte::Error naming the text if it is anything else.
double parse_memory(const std::string& text);
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
  /// @throws lte::Error if more has been added than allowed. @param stage what has been done
  void check(const std::string& stage) const;
  /// @throws lte::Error if there is no room for `more_mb`. @param what needs it, @param remedy what
  /// to do
  void check_ahead(double more_mb, const std::string& what, const std::string& remedy) const;
  /// @throws lte::Error if so many points cannot be encoded, naming how many could.
  void check_encoding(const nn::ModelConfig& config, int64_t scene_points) const;
  /// The largest block of queries that fits, at most `most`.
  /// @throws lte::Error if not even a small one does.
  int64_t query_block(const nn::ModelConfig& config, int64_t queries, int64_t most) const;

 private:
  double limit_mb_ = std::numeric_limits<double>::infinity();
  double base_mb_ = 0;
};

/// Queries that decoding takes at a time where nothing limits it.
inline constexpr int64_t kQueryBlock = int64_t{1} << 17;

/// std::bad_alloc, or LibTorch's error of the same meaning.
bool is_out_of_memory(const std::exception& error);

/// Runs `body`; where memory runs out, throws lte::Error that says what was being done, what it
/// needs and what to do.
template <typename Body>
auto explain_out_of_memory(const std::string& doing, double need_mb, const std::string& remedy,
                           const Body& body) {
  try {
    return body();
  } catch (const std::exception& error) {
    if (!is_out_of_memory(error)) throw;
    throw Error(concat("out of memory while ", doing, ", which needs about ", memory_text(need_mb),
                       " above the model: ", remedy));
  }
}

/// Starts VmHWM, which peak_rss_mb() reads, anew from what is resident now; where the system does
/// not allow it, nothing happens.
void reset_peak_rss();

}  // namespace lte::infer
