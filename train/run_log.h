// log.jsonl: one JSON object a line, of training (loss, lr, ...) and of validation (val_loss, ...),
// each with its step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lte::train {

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

  /// Appends {"step": step, fields...} and flushes. Values that are not finite become null.
  void write(int64_t step, const std::vector<std::pair<std::string, double>>& fields);

  /// All of the file.
  const std::string& text() const { return text_; }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::ofstream out_;
};

}  // namespace lte::train
