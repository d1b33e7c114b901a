#include <atomic>

#include "lte/base/parallel.h"
#include "lte/base/passive_waiting.h"
#include "lte/c_api/error.h"
#include "lte/c_api/handles.h"
#include "lte/runtime/device.h"

namespace lte::c_api {
namespace {

std::atomic<int32_t> wanted_threads{0};  ///< 0: LibTorch's default

}  // namespace

void set_threads(int32_t threads) {
  require(threads >= 1 && threads <= max_threads(), "threads is ", threads, ", expected 1 to ",
          max_threads(), ", four times the processors here or 64");
  // OpenMP's library ends the process where it gets none.
  require(can_start_threads(threads), "threads is ", threads,
          ", but the system does not give so many");
  set_num_threads(threads);
  wanted_threads = threads;
}

void apply_threads() {
  thread_local int32_t applied = -1;  // nothing yet
  const int32_t wanted = wanted_threads.load();
  if (wanted == applied) return;
  wait_passively();
  runtime::set_torch_threads(wanted);
  applied = wanted;
}

}  // namespace lte::c_api
