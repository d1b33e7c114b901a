// The books that rank 0 keeps of a training session: the line of the log that is open, with its
// clock and its sums, and the lines of training, validation and previews.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lte/base/timer.h"
#include "lte/nn/encoder/stage_health.h"
#include "train/checkpoint/checkpoint.h"
#include "train/config.h"
#include "train/log/run_log.h"
#include "train/loop/preview.h"
#include "train/loop/validate.h"

namespace lte::train {

/// Of the last step's gradient, before clipping, of each module: L2 norm and root mean square.
struct ModuleGradients {
  NamedValues norms, rms;
};

/// What stages carry and how far modules have moved, as fields of the log.
/// @param moved  WeightMovement::of(); empty: not known
NamedValues health_fields(const std::vector<nn::StageHealth>& stages, const NamedValues& moved);

class SessionLog {
 public:
  /// Opens the log of the run directory, and its event files.
  /// @param saved  the log as the checkpoint has it (RunLog)
  SessionLog(const TrainConfig& config, const RunProgress& progress,
             const std::optional<std::string>& saved);

  /// The first step begins now.
  void begin() { window_timer_.restart(); }
  /// Whether a line of training is written after `step` steps.
  bool writes_at(int64_t step) const;
  /// Counts the queries of a step in the open line.
  void add_queries(int64_t queries) { window_queries_ += queries; }

  /// Writes the open line and empties the sums in `progress`.
  /// @param norm            of the last step's gradient, before clipping
  /// @param modules         the same of each module
  /// @param waited_seconds  for examples, in the whole session
  void write_step(RunProgress* progress, double norm, const ModuleGradients& modules,
                  double waited_seconds);
  /// @param seconds  that the validation took
  /// @param health   health_fields(), in the same line
  void write_validation(int64_t step, const ValidationResult& result, double seconds,
                        const NamedValues& health);
  /// Adds the pictures of the first kKeptPreviews scenes to the event files.
  void add_pictures(int64_t step, const std::vector<PreviewPicture>& pictures);
  /// @param seconds  that drawing and writing the pictures took
  void write_previews(int64_t step, double seconds);

  /// All of log.jsonl.
  const std::string& text() const { return log_.text(); }

 private:
  OptimConfig config_;
  RunLog log_;
  // Of the steady clock, which neither the user nor a time server sets: seconds and rates are right
  // whatever happens to the time of day.
  Timer window_timer_;
  double waited_before_ = 0;  ///< for examples, as of the last line
  int64_t window_queries_ = 0;
};

}  // namespace lte::train
