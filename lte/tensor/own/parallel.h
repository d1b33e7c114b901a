// Threads, as at::parallel_for() splits work: results that depend on the split are the same.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

namespace lte::tensor {

/// Threads that a call from here would use.
int get_num_threads();
void set_num_threads(int threads);

/// Calls body(begin, end) for runs of [begin, end) that are at least `grain` long, one a thread.
void parallel_for(int64_t begin, int64_t end, int64_t grain,
                  const std::function<void(int64_t, int64_t)>& body);

/// Joins what part(begin, end, none) gives for runs of [begin, end), in their order.
template <typename T, typename Part, typename Join>
T parallel_reduce(int64_t begin, int64_t end, int64_t grain, const T& none, const Part& part,
                  const Join& join) {
  if (begin >= end) return none;
  const int64_t run = std::max({int64_t{1}, grain, (end - begin) / get_num_threads() + 1});
  std::vector<T> results(static_cast<size_t>((end - begin + run - 1) / run), none);
  parallel_for(0, static_cast<int64_t>(results.size()), 1, [&](int64_t from, int64_t to) {
    for (int64_t i = from; i < to; ++i) {
      const int64_t first = begin + i * run;
      results[static_cast<size_t>(i)] = part(first, std::min(end, first + run), none);
    }
  });
  T all = none;
  for (const T& result : results) all = join(all, result);
  return all;
}

}  // namespace lte::tensor
