// Sorting on all threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lte/base/parallel.h"

namespace lte {

/// Sorts as std::sort does. If no two items are equivalent, the result is the same for any number
/// of threads.
template <typename Item, typename Less>
void parallel_sort(std::vector<Item>* items, const Less& less) {
  constexpr int64_t kGrain = int64_t{1} << 16;
  const auto size = static_cast<int64_t>(items->size());
  const auto at = [&](int64_t i) { return items->begin() + std::min(i, size); };
  parallel_for(size, kGrain,
               [&](int64_t begin, int64_t end) { std::sort(at(begin), at(end), less); });
  std::vector<Item> other(size > kGrain ? items->size() : 0);
  for (int64_t run = kGrain; run < size; run *= 2) {
    parallel_for((size - 1) / (2 * run) + 1, 1, [&](int64_t first, int64_t last) {
      for (int64_t pair = first; pair < last; ++pair) {
        const int64_t begin = 2 * run * pair;
        std::merge(at(begin), at(begin + run), at(begin + run), at(begin + 2 * run),
                   other.begin() + begin, less);
      }
    });
    items->swap(other);
  }
}

}  // namespace lte
