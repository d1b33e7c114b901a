// A loop over many things at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lte/base/parallel.h"

namespace lte {

/// Calls `use(i)` for every i below `count`, in several threads, `grain` of them at a time: see
/// parallel_for().
template <typename Use>
void parallel_each(size_t count, int64_t grain, const Use& use) {
  parallel_for(static_cast<int64_t>(count), grain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) use(i);
  });
}

}  // namespace lte
