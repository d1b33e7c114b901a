// Ending long work early: for programs that host this library and have a Ctrl-C of their own.
#pragma once

#include <functional>

namespace lte {

/// What parallel_for() throws where an Interruption says so.
struct Interrupted {};

/// While it lives, every parallel_for() that this thread calls asks it now and then, by this
/// thread, and is over with Interrupted when it answers true. What was in work is dropped.
class Interruption {
 public:
  explicit Interruption(std::function<bool()> wanted);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// @throws Interrupted if this thread has an Interruption that wants it
  static void check();

 private:
  std::function<bool()> wanted_;
  Interruption* outer_;
};

}  // namespace lte
