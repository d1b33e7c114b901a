#include "lte/base/passive_waiting.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace lte {
namespace {

size_t threads_of_this_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<size_t>(std::distance(begin(tasks), end(tasks)));
}

/// This program has no OpenMP: there is no team, and no thread is left behind.
TEST(PassiveWaiting, ProgramsWithoutOpenMpAreLeftAlone) {
  const size_t before = threads_of_this_process();
  EXPECT_FALSE(wait_passively());
  EXPECT_EQ(threads_of_this_process(), before);
}

TEST(CanStartThreads, IsTriedOut) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer takes all addresses";
#endif
  const size_t before = threads_of_this_process();
  EXPECT_TRUE(can_start_threads(0));
  EXPECT_TRUE(can_start_threads(20));
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &old), 0);
  rlimit tight = old;
  tight.rlim_cur = rlim_t{1} << 30;  // 128 stacks of 8 MB, without the program itself
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &tight), 0);
  const bool possible = can_start_threads(1000);
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &old), 0);
  EXPECT_FALSE(possible);
  EXPECT_EQ(threads_of_this_process(), before);
}

}  // namespace
}  // namespace lte
