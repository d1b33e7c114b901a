#include "lte/base/log.h"

#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "lte/cli/progress.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Standard error of `body` at a level.
template <typename Body>
std::string stderr_of(LogLevel level, const Body& body) {
  set_log_level(level);
  testing::internal::CaptureStderr();
  body();
  set_log_level(LogLevel::Info);
  return testing::internal::GetCapturedStderr();
}

TEST(Log, ShowsWhatTheLevelAllows) {
  const auto both = [] {
    log_info("n = ", 3);
    log_warning("odd");
  };
  EXPECT_EQ(stderr_of(LogLevel::Info, both), "n = 3\nwarning: odd\n");
  EXPECT_EQ(stderr_of(LogLevel::Warning, both), "warning: odd\n");
  EXPECT_EQ(stderr_of(LogLevel::Quiet, both), "");
}

TEST(Log, FileGetsEveryLineAndIsAppendedTo) {
  const test::TempDir dir;
  write_file(dir / "log", "before\n");
  set_log_file((dir / "log").string());
  stderr_of(LogLevel::Quiet, [] {
    log_info("a");
    log_warning("b");
  });
  set_log_file("");
  stderr_of(LogLevel::Quiet, [] { log_info("c"); });
  EXPECT_EQ(read_file(dir / "log"), "before\na\nwarning: b\n");
}

TEST(Log, NamesALogFileThatCannotBeOpened) {
  const test::TempDir dir;
  EXPECT_THAT(test::error_of([&] { set_log_file((dir / "no/log").string()); }),
              HasSubstr("no/log"));
}

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
  EXPECT_THAT(text, StartsWith("baking: 1000 points in 0:01, "));
  EXPECT_THAT(text, HasSubstr(" points/s\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(stderr_of(LogLevel::Warning, work), "");
}

}  // namespace
}  // namespace lte
