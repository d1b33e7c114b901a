#include "lte/base/log.h"

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "tests/support/captured_log.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::stderr_of;
using testing::HasSubstr;

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

}  // namespace
}  // namespace lte
