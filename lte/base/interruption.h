// Ending long work early: for programs that host this library and have a Ctrl-C of their own.
#pragma once

#include <atomic>
#include <functional>

namespace lte {

/// Thrown by parallel_for() and by long loops that an Interruption ends.
struct Interrupted {};

/// While it lives, the work of this thread, and of the threads that parallel_for() starts for it,
/// ends with Interrupted soon after `wanted` answers true. What was in work is dropped.
class Interruption {
 public:
  /// @param wanted  called every few milliseconds, by this thread alone
  explicit Interruption(std::function<bool()> wanted);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Costs nothing beside a hundred rays: loops inside of parallel_for() that may take longer than
  /// a tenth of a second call it.
  /// @throws Interrupted if the work of this thread is to end
  static void check();

  /// While it lives, check() in this thread also ends work that another thread has ended.
  class Shared {
   public:
    explicit Shared(const std::atomic<bool>& ended);
    ~Shared();
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;

   private:
    const std::atomic<bool>* outer_;
  };

 private:
  std::function<bool()> wanted_;
  Interruption* outer_;
};

}  // namespace lte
