#include "lte/base/process_memory.h"

#include <cstring>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

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

TEST(AvailableMemory, IsNoMoreThanTheMachineHas) {
  const double before = available_memory_mb();
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  EXPECT_GT(before, 0);
  EXPECT_LE(before, machine / (1 << 20));
}

}  // namespace
}  // namespace lte
