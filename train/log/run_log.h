// log.jsonl: one JSON object a line, of training (loss, lr, ...) and of validation (val_loss, ...),
// each with its step; and the same figures as TensorBoard's events.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "train/log/event_file.h"

namespace lte::train {

/// What the field of a module's gradient norm begins with; the module's name follows.
inline constexpr std::string_view kModuleNormPrefix = "grad_norm_";

class RunLog {
 public:
  /// A resumed run makes the file `saved` again, the log as its checkpoint has it: lines after that
  /// are written anew by the run, and lines that a power cut took are back. Without `saved` (a
  /// checkpoint of an earlier build) the file keeps its lines up to `resume_step` and loses those
  /// after it and a last line that was cut short. A new run has resume_step 0 and starts an empty
  /// file.
  /// @throws lte::Error if the file cannot be written.
  RunLog(std::filesystem::path path, int64_t resume_step,
         const std::optional<std::string>& saved = std::nullopt);

  /// From now on also as events, in a new file of `folder`; train/log/event_file.h.
  void add_events(const std::filesystem::path& folder, int64_t resume_step) {
    events_.emplace(folder, resume_step);
  }

  /// Appends {"step": step, fields...} and flushes. Values that are not finite become null. As
  /// events, "val_loss" is val/loss, "grad_norm_nne" is grad_norm/nne, and what has neither prefix
  /// is train/NAME.
  /// @param scenes  validation loss of each scene, as the object "val_scenes"; none: no such key
  void write(int64_t step, const NamedValues& fields, const NamedValues& scenes = {});

  /// Null without add_events().
  EventFile* events() { return events_ ? &*events_ : nullptr; }

  /// All of the file.
  const std::string& text() const { return text_; }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::ofstream out_;
  std::optional<EventFile> events_;
};

}  // namespace lte::train
