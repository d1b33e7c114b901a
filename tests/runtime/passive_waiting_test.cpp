// LibTorch's threads wait asleep, unless the user has said how they are to wait.
#include "lte/base/passive_waiting.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "lte/tensor/functions.h"
#include "lte/tensor/tensor.h"
#include "tests/support/worker_sleeps.h"

namespace lte {
namespace {

constexpr int kTimes = 100;

bool user_has_a_say() {
  return std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr;
}

TEST(PassiveWaiting, WorkersSleepBetweenPiecesOfWork) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor: nobody spins";
  const int before = at::get_num_threads();
  at::set_num_threads(2);
  at::Tensor work = at::zeros({1 << 20});
  EXPECT_GE(test::worker_sleeps(kTimes, [&] { work.add_(1); }), kTimes * 9 / 10);
  at::set_num_threads(before);
  EXPECT_EQ(wait_passively(), !user_has_a_say());
}

/// Runs the test above in a process of its own.
int run_with(const std::string& setting) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command =
      setting + " '" + self + "' --gtest_filter=PassiveWaiting.WorkersSleep* > /dev/null 2>&1";
  return std::system(command.c_str());
}

TEST(PassiveWaiting, TheUsersOwnChoiceStays) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor: nobody spins";
  EXPECT_NE(run_with("OMP_WAIT_POLICY=active"), 0) << "workers sleep, and ought to spin";
  EXPECT_NE(run_with("GOMP_SPINCOUNT=100000000"), 0) << "workers sleep, and ought to spin";
  EXPECT_EQ(run_with("OMP_WAIT_POLICY=passive"), 0);
}

/// No more threads than the limit: the team would be too small to help, and nothing hangs or ends.
TEST(PassiveWaiting, AThreadLimitIsNoHarm) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  EXPECT_EQ(
      std::system(("OMP_THREAD_LIMIT=2 '" + self + "' --gtest_filter=None.* > /dev/null").c_str()),
      0);
}

}  // namespace
}  // namespace lte
