// Progress with rate and time left: a bar on a terminal, a plain line every few seconds otherwise,
// nothing under --quiet.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

#include "lte/base/timer.h"

namespace lte {

/// Thread-safe. The last line is written by the destructor or finish().
class Progress {
 public:
  /// @param label  what is going on, e.g. "baking"
  /// @param total  number of units; 0 if unknown
  /// @param unit   name of a unit in the rate, e.g. "points"
  Progress(std::string label, int64_t total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Work that an earlier run has done: `done` units, of which `timed` took `seconds` and count in
  /// the time left. Before the first advance().
  void resume(int64_t done, int64_t timed, double seconds);
  void advance(int64_t units = 1);
  void finish();

 private:
  void print(bool last);

  std::string label_, unit_;
  int64_t total_;
  int64_t earlier_ = 0, earlier_timed_ = 0;
  double earlier_seconds_ = 0;
  std::atomic<int64_t> done_{0};  // by this run
  std::atomic<int64_t> next_print_ms_{0};
  std::mutex mutex_;
  Timer timer_;
  bool terminal_, finished_ = false;
};

}  // namespace lte
