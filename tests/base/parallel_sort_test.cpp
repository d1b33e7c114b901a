#include "lte/base/parallel_sort.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte {
namespace {

TEST(ParallelSort, IsStdSort) {
  for (const size_t size : {0, 1, 2, 65535, 65536, 65537, 200'001, 262'144}) {
    Rng rng(size);
    std::vector<uint64_t> items(size);
    for (uint64_t& item : items) item = rng.next_u64() % (size + 1);
    std::vector<uint64_t> expected = items;
    std::sort(expected.begin(), expected.end(), std::greater<>());
    for (const int threads : {1, 3}) {
      set_num_threads(threads);
      std::vector<uint64_t> sorted = items;
      parallel_sort(&sorted, std::greater<>());
      EXPECT_EQ(sorted, expected) << size << " on " << threads;
    }
    set_num_threads(0);
  }
}

}  // namespace
}  // namespace lte
