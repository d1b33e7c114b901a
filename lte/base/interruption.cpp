#include "lte/base/interruption.h"

#include <utility>

namespace lte {
namespace {

thread_local Interruption* t_current = nullptr;

}  // namespace

Interruption::Interruption(std::function<bool()> wanted)
    : wanted_(std::move(wanted)), outer_(std::exchange(t_current, this)) {}

Interruption::~Interruption() { t_current = outer_; }

void Interruption::check() {
  if (t_current != nullptr && t_current->wanted_()) throw Interrupted();
}

}  // namespace lte
