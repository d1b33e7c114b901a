#include "lte/base/file.h"

#include <csignal>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/file_limit.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

TEST(AtomicFile, AppearsOnCommitOnly) {
  const TempDir dir;
  AtomicFile file(dir / "a.txt");
  file.write("hello ");
  EXPECT_FALSE(std::filesystem::exists(dir / "a.txt"));
  file.write("world");
  file.commit();
  EXPECT_EQ(read_file(dir / "a.txt"), "hello world");
  EXPECT_EQ(dir.count(), 1u);
}

TEST(AtomicFile, KeepsTheOldFileUnlessCommitted) {
  const TempDir dir;
  write_file(dir / "a.txt", "old");
  {
    AtomicFile file(dir / "a.txt");
    file.write("new");
    EXPECT_EQ(dir.count(), 2u);
  }
  EXPECT_EQ(read_file(dir / "a.txt"), "old");
  EXPECT_EQ(dir.count(), 1u);
}

TEST(AtomicFile, TwoWritersOfOneNameDoNotMix) {
  const TempDir dir;
  AtomicFile first(dir / "a.txt"), second(dir / "a.txt");
  EXPECT_NE(first.temporary_path(), second.temporary_path());
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  EXPECT_EQ(read_file(dir / "a.txt"), "first");
}

TEST(AtomicFile, TakesWhatALibraryWroteUnderTheTemporaryName) {
  const TempDir dir;
  AtomicFile file(dir / "a.bin");
  EXPECT_EQ(file.temporary_path().parent_path(), dir.path());
  std::ofstream(file.temporary_path()) << "from elsewhere";
  file.commit();
  EXPECT_EQ(read_file(dir / "a.bin"), "from elsewhere");
}

TEST(AtomicFile, FollowsASymbolicLink) {
  const TempDir dir;
  write_file(dir / "target.txt", "old");
  std::filesystem::create_symlink("target.txt", dir / "link.txt");
  write_file(dir / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(dir / "link.txt"));
  EXPECT_EQ(read_file(dir / "target.txt"), "new");
}

TEST(AtomicFile, WritesStraightIntoAPipe) {
  const TempDir dir;
  const auto name = dir / "pipe";
  ASSERT_EQ(mkfifo(name.c_str(), 0600), 0);
  const int reader = open(name.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file(name, "through");
  char text[16] = {};
  EXPECT_EQ(read(reader, text, sizeof(text)), 7);
  EXPECT_STREQ(text, "through");
  close(reader);
  EXPECT_TRUE(std::filesystem::is_fifo(name));
}

TEST(AtomicFile, NamesPathAndReasonWhenItCannotBeCreated) {
  const TempDir dir;
  EXPECT_THAT(
      error_of([&] { write_file(dir / "no/a.txt", "x"); }),
      AllOf(HasSubstr((dir / "no/a.txt").string()), HasSubstr("No such file or directory")));
  EXPECT_THAT(error_of([&] { write_file(dir.path(), "x"); }), HasSubstr("is a directory"));
  write_file(dir / "plain", "x");
  EXPECT_THAT(error_of([&] { write_file(dir / "plain/a.txt", "x"); }),
              HasSubstr("Not a directory"));
}

TEST(AtomicFile, NamesMissingPermission) {
  constexpr uid_t kNobody = 65534;
  const TempDir dir;
  ASSERT_EQ(chmod(dir.path().c_str(), 0555), 0);
  const bool superuser = geteuid() == 0;  // may write anywhere, so steps down for a moment
  if (superuser) {
    ASSERT_EQ(seteuid(kNobody), 0);
  }
  const std::string message = error_of([&] { write_file(dir / "a.txt", "x"); });
  if (superuser) {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_THAT(message, HasSubstr("Permission denied"));
  chmod(dir.path().c_str(), 0700);
}

TEST(AtomicFile, ReportsAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_THROW(write_file("/dev/full", "x"), DiskFull);
  EXPECT_THAT(error_of([] { write_file("/dev/full", "x"); }),
              AllOf(HasSubstr("/dev/full"), HasSubstr("No space left on device")));
}

TEST(AtomicFile, LeavesNothingWhenAWriteFails) {
  const TempDir dir;
  std::string message;
  {
    const test::FileLimit full(4096);
    message = error_of([&] { write_file(dir / "a.bin", std::string(100'000, 'x')); });
    EXPECT_THROW(write_file(dir / "a.bin", std::string(100'000, 'x')), DiskFull);
  }
  EXPECT_THAT(message, AllOf(HasSubstr("a.bin"), HasSubstr("File too large")));
  EXPECT_EQ(dir.count(), 0u);
}

TEST(AtomicFile, RefusesUseAfterCommit) {
  const TempDir dir;
  AtomicFile file(dir / "a.txt");
  file.commit();
  EXPECT_THAT(error_of([&] { file.write("x"); }), HasSubstr("already committed"));
  EXPECT_THAT(error_of([&] { file.commit(); }), HasSubstr("already committed"));
}

class SignalCleanup : public testing::TestWithParam<int> {};

TEST_P(SignalCleanup, RemovesTemporariesAndExitsWith128PlusTheNumber) {
  const TempDir dir;
  write_file(dir / "old.txt", "old");
  const pid_t child = fork();
  if (child == 0) {
    install_signal_cleanup();
    AtomicFile one(dir / "old.txt"), two(dir / "new.txt");
    one.write("half");
    raise(GetParam());
    _exit(0);  // not reached
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + GetParam());
  EXPECT_EQ(dir.count(), 1u);
  EXPECT_EQ(read_file(dir / "old.txt"), "old");
}

INSTANTIATE_TEST_SUITE_P(Signals, SignalCleanup, testing::Values(SIGINT, SIGTERM));

TEST(ReadFile, ReturnsEveryByte) {
  const TempDir dir;
  std::string bytes(200'000, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  write_file(dir / "a.bin", bytes);
  EXPECT_EQ(read_file(dir / "a.bin"), bytes);
  EXPECT_EQ(read_file(dir / "a.bin", bytes.size()), bytes);
}

TEST(ReadFile, RefusesWhatItCannotRead) {
  const TempDir dir;
  write_file(dir / "a.bin", std::string(1001, 'x'));
  EXPECT_THAT(error_of([&] { read_file(dir / "a.bin", 1000); }),
              AllOf(HasSubstr("a.bin"), HasSubstr("1000")));
  EXPECT_THAT(error_of([&] { read_file(dir / "none"); }), HasSubstr("No such file"));
  EXPECT_THAT(error_of([&] { read_file(dir.path()); }), HasSubstr("is a directory"));
}

TEST(MappedFile, SeesTheBytes) {
  const TempDir dir;
  write_file(dir / "a.bin", "abc");
  const MappedFile file(dir / "a.bin");
  ASSERT_EQ(file.size(), 3u);
  EXPECT_EQ(file.data()[1], std::byte{'b'});
}

TEST(MappedFile, EmptyFileHasNoBytes) {
  const TempDir dir;
  write_file(dir / "a.bin", "");
  EXPECT_EQ(MappedFile(dir / "a.bin").size(), 0u);
}

TEST(MappedFile, RefusesWhatIsNoFile) {
  const TempDir dir;
  EXPECT_THAT(error_of([&] { MappedFile{dir / "none"}; }), HasSubstr("No such file"));
  EXPECT_THAT(error_of([&] { MappedFile{dir.path()}; }), HasSubstr("not a regular file"));
}

TEST(ReadWatch, SeesWhatIsReadWhileItLives) {
  const TempDir dir;
  for (const char* name : {"before", "read", "mapped", "untouched"}) write_file(dir / name, name);
  read_file(dir / "before");
  const ReadWatch watch;
  read_file(dir / "read");
  std::filesystem::create_symlink(dir / "mapped", dir / "link");
  const MappedFile map(dir / "link");
  EXPECT_FALSE(watch.saw(dir / "before"));
  EXPECT_TRUE(watch.saw(dir / "read"));
  EXPECT_TRUE(watch.saw(dir / "mapped"));
  EXPECT_FALSE(watch.saw(dir / "untouched"));
  EXPECT_FALSE(watch.saw(dir / "missing"));
}

TEST(SignalNote, IsSaidByTheHandlerWhileItLives) {
  const auto killed = [](bool noted) {
    install_signal_cleanup();
    if (noted) {
      const SignalNote note("go on with --resume");
      std::raise(SIGINT);
    } else {
      { const SignalNote note("go on with --resume"); }
      std::raise(SIGINT);
    }
  };
  EXPECT_EXIT(killed(true), testing::ExitedWithCode(128 + SIGINT), "^go on with --resume\n$");
  EXPECT_EXIT(killed(false), testing::ExitedWithCode(128 + SIGINT), "^$");
}

}  // namespace
}  // namespace lte
