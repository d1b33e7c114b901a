#include "lte/cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <unistd.h>

#include "lte/base/log.h"
#include "lte/base/text.h"

namespace lte {
namespace {

constexpr int64_t kTerminalIntervalMs = 100;
constexpr int64_t kPlainIntervalMs = 5000;
constexpr int kBarWidth = 24;

/// "12.3k", "4.56M": three digits are what an eye takes in.
std::string short_number(double value) {
  const char* suffix = "";
  for (const char* next : {"k", "M", "G", "T"}) {
    if (value < 999.5) break;
    value /= 1000;
    suffix = next;
  }
  return formatted("%.3g%s", value, suffix);
}

/// "1:02:03" or "2:03".
std::string clock_time(double seconds) {
  const auto total = static_cast<long long>(std::ceil(std::min(seconds, 3.6e9)));
  if (total < 3600) return formatted("%lld:%02lld", total / 60, total % 60);
  return formatted("%lld:%02lld:%02lld", total / 3600, total / 60 % 60, total % 60);
}

/// "0.15 s", "12 s", then "1:02": what the rate beside it was computed from.
std::string time_taken(double seconds) {
  return seconds < 59.5 ? formatted("%.2g s", seconds) : clock_time(seconds);
}

std::string bar(double fraction) {
  const int filled = static_cast<int>(fraction * kBarWidth);
  std::string text(kBarWidth, ' ');
  std::fill_n(text.begin(), filled, '=');
  if (filled < kBarWidth) text[static_cast<size_t>(filled)] = '>';
  return "[" + text + "] ";
}

int64_t milliseconds(const Timer& timer) { return static_cast<int64_t>(timer.seconds() * 1e3); }

}  // namespace

Progress::Progress(std::string label, int64_t total, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(std::max<int64_t>(total, 0)),
      terminal_(isatty(STDERR_FILENO) == 1) {
  next_print_ms_ = terminal_ ? kTerminalIntervalMs : kPlainIntervalMs;
}

Progress::~Progress() { finish(); }

void Progress::resume(int64_t done, int64_t timed, double seconds) {
  earlier_ = done;
  earlier_timed_ = timed;
  earlier_seconds_ = seconds;
}

void Progress::advance(int64_t units) {
  done_.fetch_add(units, std::memory_order_relaxed);
  const int64_t now = milliseconds(timer_);
  int64_t due = next_print_ms_.load(std::memory_order_relaxed);
  if (now < due) return;
  // One thread wins the right to print; the others go back to work.
  const int64_t next = now + (terminal_ ? kTerminalIntervalMs : kPlainIntervalMs);
  if (next_print_ms_.compare_exchange_strong(due, next)) print(false);
}

void Progress::finish() { print(true); }

void Progress::print(bool last) {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  finished_ = last;
  const int64_t done = done_;
  const double seconds = std::max(timer_.seconds(), 1e-6);
  const double rate = static_cast<double>(done) / seconds;
  const std::string speed = concat(short_number(rate), " ", unit_, "/s");
  if (last) {
    log_info(label_, ": ", done, " ", unit_, " in ", time_taken(seconds), ", ", speed);
    return;
  }
  if (log_level() < LogLevel::Info) return;
  const int64_t all = earlier_ + done;
  std::string counts = concat(all, " ", unit_);
  std::string left;
  double fraction = 0;
  if (total_ > 0) {
    fraction = std::min(1.0, static_cast<double>(all) / static_cast<double>(total_));
    counts = concat(static_cast<int>(100 * fraction), "% ", all, "/", total_, " ", unit_);
    const auto remaining = static_cast<double>(std::max<int64_t>(total_ - all, 0));
    const auto timed = static_cast<double>(earlier_timed_ + done);
    if (timed > 0)
      left = concat(", ", clock_time(remaining * (earlier_seconds_ + seconds) / timed), " left");
  }
  if (terminal_) {
    const std::string line =
        concat("\r\033[K", label_, " ", total_ > 0 ? bar(fraction) : "", counts, ", ", speed, left);
    std::fputs(line.c_str(), stderr);
  } else {
    log_info(label_, ": ", counts, ", ", speed, left);
  }
}

}  // namespace lte
