#include "lte/cli/progress.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "tests/support/captured_log.h"

namespace lte {
namespace {

using test::stderr_of;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Progress, EarlierWorkIsNotInTheRate) {
  const std::string text = stderr_of(LogLevel::Info, [] {
    Progress progress("baking", 1000, "points");
    progress.resume(990, 100, 1e6);
    progress.advance(5);
  });
  EXPECT_THAT(text, StartsWith("baking: 5 points in"));
}

TEST(Progress, EndsWithOneLineOfTotals) {
  const auto work = [] {
    Progress progress("baking", 1000, "points");
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 250; ++i) progress.advance();
      });
    }
    for (std::thread& thread : threads) thread.join();
    progress.finish();
    progress.finish();
  };
  const std::string text = stderr_of(LogLevel::Info, work);
  double seconds = 0, rate = 0;
  char suffix = ' ';
  ASSERT_GE(
      std::sscanf(text.c_str(), "baking: 1000 points in %lf s, %lf%c", &seconds, &rate, &suffix), 3)
      << text;
  const std::map<char, double> factors = {{' ', 1}, {'k', 1e3}, {'M', 1e6}, {'G', 1e9}};
  ASSERT_TRUE(factors.contains(suffix)) << text;
  EXPECT_NEAR(factors.at(suffix) * rate * seconds / 1000, 1, 0.1)
      << "time and rate are of one clock: " << text;
  EXPECT_THAT(text, HasSubstr(" points/s\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(stderr_of(LogLevel::Warning, work), "");
}

}  // namespace
}  // namespace lte
