#include "train/loop/interrupt.h"

#include <array>
#include <atomic>
#include <csignal>

namespace lte::train {
namespace {

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};

std::atomic<int> g_signal{0};
std::array<struct sigaction, kSignals.size()> g_before;
static_assert(std::atomic<int>::is_always_lock_free, "the signal handler writes it");

void restore() {
  for (size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &g_before[i], nullptr);
}

extern "C" void note_signal(int signal) {
  g_signal = signal;
  restore();  // sigaction() is async-signal-safe
}

}  // namespace

InterruptGuard::InterruptGuard() {
  g_signal = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  // All are known before one is replaced, as the handler restores them all.
  for (size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], nullptr, &g_before[i]);
  for (const int signal : kSignals) sigaction(signal, &action, nullptr);
}

InterruptGuard::~InterruptGuard() { restore(); }

int interrupt_signal() { return g_signal; }

}  // namespace lte::train
