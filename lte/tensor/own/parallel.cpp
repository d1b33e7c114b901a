#include "lte/tensor/own/parallel.h"

#include <atomic>
#include <exception>
#include <mutex>

#include <omp.h>

#include "lte/base/interruption.h"

namespace lte::tensor {

int get_num_threads() { return omp_in_parallel() != 0 ? 1 : omp_get_max_threads(); }
void set_num_threads(int threads) { omp_set_num_threads(threads); }

void parallel_for(int64_t begin, int64_t end, int64_t grain,
                  const std::function<void(int64_t, int64_t)>& body) {
  Interruption::check();
  const int64_t count = end - begin;
  if (count <= 0) return;
  if (count <= grain || count == 1 || get_num_threads() == 1) {
    body(begin, end);
    return;
  }
  std::exception_ptr error;
  std::mutex mutex;
  std::atomic<bool> failed{false};
#pragma omp parallel
  {
    const Interruption::Shared shared(failed);
    int64_t threads = omp_get_num_threads();
    if (grain > 0) threads = std::min(threads, (count + grain - 1) / grain);
    const int64_t run = (count + threads - 1) / threads;
    const int64_t first = begin + omp_get_thread_num() * run;
    if (first < end) {
      try {
        body(first, std::min(end, first + run));
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failed) error = std::current_exception();
        failed = true;
      }
    }
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace lte::tensor
