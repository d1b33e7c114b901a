// Wall-clock and processor seconds.
#pragma once

#include <chrono>
#include <ctime>

namespace lte {

class Timer {
 public:
  void restart() { start_ = std::chrono::steady_clock::now(); }
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Seconds of all threads of this process, user's and system's: what else runs on the machine takes
/// wall time alone.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace lte
