#include "lte/base/parallel.h"

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/interruption.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

/// Sets the number of threads for one test.
class Threads {
 public:
  explicit Threads(int threads) { set_num_threads(threads); }
  ~Threads() { set_num_threads(0); }
};

TEST(ParallelFor, CoversEveryIndexOnceInChunksOfTheGrain) {
  for (const int threads : {1, 2, 5}) {
    const Threads scope(threads);
    for (const int64_t count : {0, 1, 6, 7, 8, 1000}) {
      std::vector<std::atomic<int>> hits(static_cast<size_t>(count));
      parallel_for(count, 7, [&](int64_t begin, int64_t end) {
        EXPECT_EQ(begin % 7, 0);
        EXPECT_TRUE(end - begin == 7 || end == count);
        for (int64_t i = begin; i < end; ++i) ++hits[static_cast<size_t>(i)];
      });
      for (const auto& hit : hits) ASSERT_EQ(hit, 1) << threads << " threads, count " << count;
    }
  }
}

TEST(ParallelFor, ToleratesTheLargestCounts) {
  int64_t last = 0;
  const Threads scope(2);
  std::mutex mutex;
  parallel_for(INT64_MAX, INT64_MAX / 2, [&](int64_t, int64_t end) {
    const std::lock_guard lock(mutex);
    last = std::max(last, end);
  });
  EXPECT_EQ(last, INT64_MAX);
}

TEST(ParallelFor, UsesTheNumberOfThreadsAsked) {
  const Threads scope(3);
  EXPECT_EQ(num_threads(), 3);
  std::atomic<int> inside{0};
  std::set<std::thread::id> ids;
  std::mutex mutex;
  parallel_for(3, 1, [&](int64_t, int64_t) {
    ++inside;
    while (inside < 3) std::this_thread::yield();  // all three must be here at once
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(ids.size(), 3u);
}

TEST(ParallelFor, RunsInlineWhenNested) {
  const Threads scope(4);
  std::atomic<int64_t> sum{0};
  parallel_for(8, 1, [&](int64_t outer, int64_t) {
    const auto id = std::this_thread::get_id();
    parallel_for(8, 1, [&](int64_t inner, int64_t) {
      EXPECT_EQ(std::this_thread::get_id(), id);
      sum += 8 * outer + inner;
    });
  });
  EXPECT_EQ(sum, 63 * 64 / 2);
}

TEST(ParallelFor, RethrowsTheFirstErrorAndStops) {
  for (const int threads : {1, 4}) {
    const Threads scope(threads);
    std::atomic<int> calls{0};
    const std::string message = test::error_of([&] {
      parallel_for(1'000'000, 1, [&](int64_t begin, int64_t) {
        ++calls;
        LTE_CHECK(begin != 3, "chunk ", begin);
      });
    });
    EXPECT_EQ(message, "chunk 3");
    EXPECT_LT(calls, 1'000'000);
  }
}

TEST(ParallelFor, WorksAgainAfterAnError) {
  EXPECT_THROW(parallel_for(1, 1, [](int64_t, int64_t) { throw Error("x"); }), Error);
  const Threads scope(2);
  std::atomic<int> inside{0};
  parallel_for(2, 1, [&](int64_t, int64_t) {
    ++inside;
    while (inside < 2) std::this_thread::yield();
  });
  EXPECT_EQ(inside, 2);
}

TEST(ParallelFor, RefusesBadArguments) {
  EXPECT_THROW(parallel_for(1, 0, [](int64_t, int64_t) {}), Error);
  EXPECT_THROW(set_num_threads(-1), Error);
  EXPECT_GE(num_threads(), 1);
}

TEST(SetNumThreads, RefusesMoreThanAFewForEachProcessor) {
  EXPECT_GE(max_threads(), 64);
  EXPECT_GE(max_threads(), 4 * static_cast<int>(std::thread::hardware_concurrency()));
  const Threads scope(max_threads());
  EXPECT_EQ(num_threads(), max_threads());
  EXPECT_THROW(set_num_threads(max_threads() + 1), Error);
  EXPECT_THROW(set_num_threads(1 << 30), Error);
  EXPECT_EQ(num_threads(), max_threads());
}

TEST(Interruption, EndsTheWorkOfItsThreadAlone) {
  for (const int threads : {1, 3}) {
    const Threads scope(threads);
    std::atomic<int64_t> done{0};
    const auto count = [&](int64_t begin, int64_t end) { done += end - begin; };
    {
      int asked = 0;
      const Interruption interruption([&] { return ++asked > 5; });
      EXPECT_THROW(parallel_for(1 << 30, 1, count), Interrupted);
      EXPECT_GE(done, 5);
      EXPECT_LT(done, 1 << 30);
      std::jthread([&] { EXPECT_NO_THROW(parallel_for(9, 1, count)); });
    }
    done = 0;
    EXPECT_NO_THROW(parallel_for(9, 1, count));
    EXPECT_EQ(done, 9);
  }
}

TEST(Interruption, EndsLongBodiesInEveryThread) {
  const Threads scope(3);
  std::atomic<int> at_work{0};
  const Interruption interruption([&] { return at_work == 3; });
  EXPECT_THROW(parallel_for(3, 1,
                            [&](int64_t, int64_t) {
                              ++at_work;
                              // A job inside, whose end is not that of the work.
                              parallel_for(2, 1, [](int64_t, int64_t) {});
                              for (;;) Interruption::check();
                            }),
               Interrupted);
  EXPECT_EQ(at_work, 3);
}

TEST(Interruption, TheInnerOneCounts) {
  const Interruption outer([] { return true; });
  {
    const Interruption inner([] { return false; });
    EXPECT_NO_THROW(Interruption::check());
  }
  EXPECT_THROW(Interruption::check(), Interrupted);
}

}  // namespace
}  // namespace lte
