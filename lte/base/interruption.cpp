#include "lte/base/interruption.h"

#include <utility>

namespace lte {
namespace {

thread_local Interruption* t_current = nullptr;
thread_local const std::atomic<bool>* t_ended = nullptr;

}  // namespace

Interruption::Interruption(std::function<bool()> wanted)
    : wanted_(std::move(wanted)), outer_(std::exchange(t_current, this)) {}

Interruption::~Interruption() { t_current = outer_; }

void Interruption::check() {
  if (t_ended != nullptr && t_ended->load(std::memory_order_relaxed)) throw Interrupted();
  if (t_current != nullptr && t_current->wanted_()) throw Interrupted();
}

Interruption::Shared::Shared(const std::atomic<bool>& ended)
    : outer_(std::exchange(t_ended, &ended)) {}

Interruption::Shared::~Shared() { t_ended = outer_; }

}  // namespace lte
