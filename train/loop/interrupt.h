// Ctrl-C while training: the step is finished and a checkpoint written before the run ends.
#pragma once

namespace lte::train {

/// While it lives, the first SIGINT or SIGTERM is only noted; a second one has the effect it had
/// before, for those who cannot wait for the step's end.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// @return number of the signal noted since the last InterruptGuard was made; 0 if none was
int interrupt_signal();

}  // namespace lte::train
