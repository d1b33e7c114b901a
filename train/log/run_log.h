// log.jsonl: one JSON object a line, of training (loss, lr, ...) or of validation (val_loss, ...),
// each with its step. The same figures go to TensorBoard's event files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "train/log/append_file.h"
#include "train/log/event_file.h"

namespace lte::train {

/// What the field of a module's gradient norm begins with; the module's name follows.
inline constexpr std::string_view kModuleNormPrefix = "grad_norm_";
/// And of the root mean square of its entries.
inline constexpr std::string_view kModuleRmsPrefix = "grad_rms_";
/// What the fields of nn::StageHealth and of WeightMovement begin with; the figure's name, '_', and
/// that of the stage or module follow.
inline constexpr std::string_view kHealthPrefix = "health_";

class RunLog {
 public:
  /// Opens the file. In a resumed run it becomes `saved` again, the log as the checkpoint has it:
  /// the run writes later lines anew, and lines that a power cut took are back. Without `saved` (a
  /// checkpoint of an earlier build) it keeps its lines up to `resume_step`, and loses later ones
  /// and a last one that was cut short. In a new run, whose resume_step is 0, it is emptied.
  /// @throws lte::Error if the file cannot be written for another reason than a full disk.
  RunLog(std::filesystem::path path, int64_t resume_step,
         const std::optional<std::string>& saved = std::nullopt);

  /// Tries once more to write what a full disk has kept out, and says how many lines that were.
  ~RunLog();
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

  /// From now on lines are written as events too, to a new file in `folder` (event_file.h).
  void add_events(const std::filesystem::path& folder, int64_t resume_step) {
    events_.emplace(folder, resume_step);
  }

  /// Appends {"step": step, fields...} and flushes. Values that are not finite become null. As
  /// events "val_loss" is val/loss, "grad_norm_nne" is grad_norm/nne, "health_rms_up0" is
  /// health/rms_up0, and a field with none of these prefixes is train/NAME. On a full disk the line
  /// waits in memory and is written with the next one for which there is room; the first that
  /// waits, and the end of the waiting, are said.
  /// @param scenes  validation loss of each scene, as the object "val_scenes"; empty: no such key
  void write(int64_t step, const NamedValues& fields, const NamedValues& scenes = {});

  /// Null without add_events().
  EventFile* events() { return events_ ? &*events_ : nullptr; }

  /// What the file holds, or will when there is room.
  const std::string& text() const { return text_; }

 private:
  void write_waiting();
  int64_t waiting_lines() const;

  std::filesystem::path path_;
  std::string text_;
  size_t written_ = 0;                ///< of text_, in bytes
  std::unique_ptr<AppendFile> file_;  ///< null as long as the file does not begin as text_ does
  std::string fault_;                 ///< why lines wait; empty: none do
  std::optional<EventFile> events_;
};

}  // namespace lte::train
