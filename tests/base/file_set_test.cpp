#include "lte/base/file_set.h"

#include <gmock/gmock.h>

#include "tests/support/file_limit.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(FileSet, AllAppearWithCommit) {
  const TempDir dir;
  const auto folder = dir / "deep/out";
  FileSet files(folder);
  files.write("a.txt", "first");
  files.write("b.txt", [](const auto& path) { write_file(path, "second"); });
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.txt"));
  files.commit();
  EXPECT_EQ(read_file(folder / "a.txt"), "first");
  EXPECT_EQ(read_file(folder / "b.txt"), "second");
}

TEST(FileSet, WithoutCommitOldFilesStay) {
  const TempDir dir;
  write_file(dir / "a.txt", "old");
  {
    FileSet files(dir.path());
    files.write("a.txt", "new");
    files.write("b.txt", "new");
  }
  EXPECT_THAT(dir.names(), ElementsAre("a.txt"));
  EXPECT_EQ(read_file(dir / "a.txt"), "old");
  { FileSet files(dir / "made"); }
  EXPECT_THAT(dir.names(), ElementsAre("a.txt"));
}

TEST(FileSet, AFullDiskLeavesNothingAndNamesTheFile) {
  const TempDir dir;
  const auto fill = [&] {
    FileSet files(dir / "out");
    files.write("small.txt", "x");
    files.write("large.bin", std::string(100'000, 'x'));
    files.commit();
  };
  const test::FileLimit full(4096);
  EXPECT_THROW(fill(), DiskFull);
  EXPECT_THAT(error_of(fill),
              AllOf(HasSubstr((dir / "out/large.bin").string() + ": "), Not(HasSubstr(".tmp-"))));
  EXPECT_EQ(dir.count(), 0u);
}

TEST(FileSet, PassesErrorsOfWritersOn) {
  const TempDir dir;
  FileSet files(dir.path());
  const std::string message = error_of([&] {
    files.write("a.exr", [](const auto& path) { throw Error(path.string() + ": no layers"); });
  });
  EXPECT_EQ(message, (dir / "a.exr").string() + ": no layers");
}

}  // namespace
}  // namespace lte
