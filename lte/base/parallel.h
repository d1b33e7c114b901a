// Threads for the parts that do not link LibTorch. Results must not depend on how work is split:
// pass seeds, not state.
#pragma once

#include <cstdint>
#include <functional>

namespace lte {

/// The most threads that may be asked for: four times the processors, and 64 at least. More only
/// wait for one another, and at some thousands the system gives no more.
int max_threads();

/// Sets the number of threads, once at start-up. 0 restores the default, every hardware thread.
/// @throws lte::Error unless it is in [0, max_threads()].
void set_num_threads(int threads);
int num_threads();

/// Calls `body(begin, end)` over disjoint chunks of at most `grain` that cover [0, count), on
/// num_threads() threads. Chunks are handed out in order. The first exception is rethrown here
/// after all threads have stopped.
void parallel_for(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)>& body);

}  // namespace lte
