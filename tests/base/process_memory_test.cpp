#include "lte/base/process_memory.h"

#include <cstring>

#include <gtest/gtest.h>
#include <sys/mman.h>

namespace lte {
namespace {

TEST(ResidentSet, GrowsWithTouchedMemory) {
  const double before = current_rss_mb();
  EXPECT_GT(before, 0);
  constexpr size_t kSize = size_t{64} << 20;
  // Straight from the system: the heap may hand out memory that is resident already.
  void* block = mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  std::memset(block, 1, kSize);
  EXPECT_NEAR(current_rss_mb() - before, 64, 8);
  munmap(block, kSize);
  EXPECT_NEAR(current_rss_mb(), before, 8);
  EXPECT_GE(peak_rss_mb(), before + 56);
}

}  // namespace
}  // namespace lte
