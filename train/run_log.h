// log.jsonl: one JSON object a line, of training (loss, lr, ...) and of validation (val_loss, ...),
// each with its step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace lte::train {

class RunLog {
 public:
  /// Keeps the lines up to `resume_step` and drops those after it, which the resumed run writes
  /// again, and a last line that was cut short. A new run has resume_step 0 and starts an empty
  /// file.
  /// @throws lte::Error if the file cannot be written.
  RunLog(std::filesystem::path path, int64_t resume_step);

  /// Appends {"step": step, fields...} and flushes. Values that are not finite become null.
  void write(int64_t step, const std::vector<std::pair<std::string, double>>& fields);

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace lte::train
