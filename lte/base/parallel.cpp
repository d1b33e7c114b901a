#include "lte/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/interruption.h"

namespace lte {
namespace {

std::atomic<int> g_threads{0};

int processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

/// True inside a body, so that a nested call runs inline instead of multiplying the threads.
thread_local bool t_inside = false;

/// What the threads of one call share.
class Job {
 public:
  Job(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)>& body)
      : count_(count), grain_(grain), body_(body) {}

  void work() {
    const bool outer = t_inside;
    t_inside = true;
    try {
      // Of nested jobs, the outermost is the one that several threads share.
      std::optional<Interruption::Shared> shared;
      if (!outer) shared.emplace(failed_);
      while (!failed_.load(std::memory_order_relaxed)) {
        Interruption::check();
        const int64_t chunk = next_.fetch_add(1, std::memory_order_relaxed);
        if (chunk > (count_ - 1) / grain_) break;
        const int64_t begin = chunk * grain_;
        body_(begin, begin + std::min(grain_, count_ - begin));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
    t_inside = outer;
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const int64_t count_, grain_;
  const std::function<void(int64_t, int64_t)>& body_;
  std::atomic<int64_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

int max_threads() { return std::max(64, 4 * processors()); }

void set_num_threads(int threads) {
  LTE_CHECK(threads >= 0 && threads <= max_threads(), "number of threads: expected 0 (all) to ",
            max_threads(), ", got ", threads);
  g_threads = threads;
}

int num_threads() {
  const int threads = g_threads;
  return threads > 0 ? threads : processors();
}

void parallel_for(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)>& body) {
  LTE_CHECK(grain > 0, "parallel_for: expected a positive grain, got ", grain);
  if (count <= 0) return;
  Job job(count, grain, body);
  const int64_t chunks = (count - 1) / grain + 1;
  const int64_t workers = t_inside ? 1 : std::min<int64_t>(num_threads(), chunks);
  std::vector<std::jthread> threads;  // joined before the job goes, whatever is thrown
  threads.reserve(static_cast<size_t>(workers - 1));
  for (int64_t i = 1; i < workers; ++i) {
    try {
      threads.emplace_back(&Job::work, &job);
    } catch (const std::system_error&) {
      break;  // The system gives no more threads; those there are finish the work.
    }
  }
  job.work();
  threads.clear();
  job.rethrow();
}

}  // namespace lte
