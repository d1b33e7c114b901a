#include "lte/base/locked_file.h"

#include <memory>

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using testing::HasSubstr;

TEST(LockedFile, OneHolderAtATime) {
  const test::TempDir dir;
  auto first = std::make_unique<LockedFile>(dir / "a.log");
  EXPECT_FALSE(first->busy());
  EXPECT_TRUE(LockedFile(dir / "a.log").busy());
  EXPECT_FALSE(LockedFile(dir / "b.log").busy());
  first.reset();
  EXPECT_FALSE(LockedFile(dir / "a.log").busy());
}

TEST(LockedFile, AppendsToWhatIsThere) {
  const test::TempDir dir;
  write_file(dir / "a.log", "one\n");
  LockedFile file(dir / "a.log");
  file.append("two\n");
  file.append("");
  file.append("three\n");
  EXPECT_EQ(read_file(dir / "a.log"), "one\ntwo\nthree\n");
}

TEST(LockedFile, NamesWhatCannotBeOpened) {
  const test::TempDir dir;
  EXPECT_THAT(test::error_of([&] { LockedFile{dir / "no/a.log"}; }), HasSubstr("no/a.log"));
}

TEST(LockedFile, RemovedItIsMadeAnew) {
  const test::TempDir dir;
  auto first = std::make_unique<LockedFile>(dir / "a.lock");
  EXPECT_TRUE(first->made());
  first->remove();
  EXPECT_EQ(dir.count(), 0u);
  const LockedFile second(dir / "a.lock");
  EXPECT_TRUE(second.made());
  EXPECT_FALSE(second.busy()) << "the file that is locked still is another one";
  first.reset();
  EXPECT_TRUE(LockedFile(dir / "a.lock").busy());
  EXPECT_FALSE(LockedFile(dir / "a.lock").made());
}

TEST(Temporaries, AreToldByTheirNames) {
  const test::TempDir dir;
  const AtomicFile file(dir / "a.tmp-b.txt");
  EXPECT_EQ(temporary_of(file.temporary_path().filename().string()), "a.tmp-b.txt");
  EXPECT_EQ(temporary_of("a.txt"), "");
  EXPECT_EQ(temporary_of("a.tmp-1-2-3"), "");
  EXPECT_EQ(temporary_of(".hidden"), "");
}

TEST(MakeDirectory, WithParentsAndTwice) {
  const test::TempDir dir;
  make_directory(dir / "a/b/c");
  make_directory(dir / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(dir / "a/b/c"));
  write_file(dir / "file", "");
  EXPECT_THAT(test::error_of([&] { make_directory(dir / "file/x"); }),
              HasSubstr("cannot make the directory"));
}

}  // namespace
}  // namespace lte
