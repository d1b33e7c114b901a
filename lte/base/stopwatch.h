// Seconds by the clock and of processors at once.
#pragma once

#include "lte/base/timer.h"

namespace lte {

struct Seconds {
  double wall = 0, processor = 0;  ///< the processor's are of all threads
  Seconds operator+(const Seconds& o) const { return {wall + o.wall, processor + o.processor}; }
};

/// Runs from its making on.
class Stopwatch {
 public:
  Seconds seconds() const { return {timer_.seconds(), processor_seconds() - start_}; }

 private:
  Timer timer_;
  double start_ = processor_seconds();
};

}  // namespace lte
