#include "lte/cli/command_files.h"

#include <gmock/gmock.h>

#include "lte/cli/cli.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::write_text;
using testing::AllOf;
using testing::HasSubstr;

class CommandFilesTest : public testing::Test {
 protected:
  CommandFilesTest() {
    write_text(dir_ / "room.glb", "scene");
    fs::create_directories(dir_ / "homes/scenes");
    write_text(dir_ / "homes/dataset.json", "{}");
    write_text(dir_ / "homes/scenes/a.safetensors", "a");
    fs::create_symlink(dir_ / "room.glb", dir_ / "link.glb");
    fs::create_hard_link(dir_ / "room.glb", dir_ / "twin.glb");
    fs::create_directory_symlink(dir_ / "homes", dir_ / "houses");
    fs::create_hard_link(dir_ / "homes/scenes/a.safetensors", dir_ / "b.safetensors");
    fs::create_symlink(dir_ / "later.json", dir_ / "dangling.json");
  }

  /// Whether a command may read `input` and write `output`; a data set if `input` is its folder.
  void expect(const std::string& input, const fs::path& output, bool allowed) const {
    SCOPED_TRACE(input + " -> " + output.string());
    CommandFiles files;
    if (fs::is_directory(dir_ / input)) {
      files.reads_parts("--data", dir_ / input, {"dataset.json", "scenes"});
    } else {
      files.reads("--data", dir_ / input);
    }
    files.writes("--out", output);
    if (allowed) {
      EXPECT_NO_THROW(files.check());
    } else {
      EXPECT_THAT(error_of([&] { files.check(); }),
                  AllOf(HasSubstr("--out " + output.string()), HasSubstr("--data")));
    }
  }

  test::TempDir dir_;
};

TEST_F(CommandFilesTest, AnInputIsAnInputByWhateverName) {
  expect("room.glb", dir_ / "room.glb", false);
  expect("room.glb", dir_ / "homes/../room.glb", false);
  expect("room.glb", dir_ / "link.glb", false);
  expect("room.glb", dir_ / "twin.glb", false);
  expect("link.glb", dir_ / "twin.glb", false);
  expect("room.glb", fs::relative(dir_ / "room.glb"), false);
  expect("room.glb", dir_ / "other.glb", true);
  expect("missing.glb", dir_ / "missing.glb", false);
  expect("missing.glb", dir_ / "houses/../missing.glb", false);
  expect("later.json", dir_ / "dangling.json", false);
  expect("room.glb", dir_ / "dangling.json", true);
}

TEST_F(CommandFilesTest, WhatBelongsToAFolderIsAnInputToo) {
  expect("homes", dir_ / "homes/dataset.json", false);
  expect("homes", dir_ / "houses/dataset.json", false);
  expect("houses", dir_ / "homes/scenes/a.safetensors", false);
  expect("homes", dir_ / "homes/scenes/new.json", false);
  expect("homes", dir_ / "homes/scenes", false);
  expect("homes", dir_ / "b.safetensors", false);
  expect("homes", dir_ / "homes/notes.json", true);
  expect("homes", dir_ / "scenes", true);
}

TEST_F(CommandFilesTest, AFolderThatIsWrittenClaimsItsPartsAlone) {
  CommandFiles files;
  files.reads("--config", dir_ / "homes/config.yaml");
  files.writes_parts("--out", dir_ / "houses", {"config.yaml", "scenes"});
  EXPECT_THAT(error_of([&] { files.check(); }), AllOf(HasSubstr("--out"), HasSubstr("--config")));
  CommandFiles others;
  others.reads("--config", dir_ / "homes/mine.yaml");
  others.writes_parts("--out", dir_ / "homes", {"config.yaml", "scenes"});
  EXPECT_NO_THROW(others.check());
}

TEST_F(CommandFilesTest, OutputsAreNotOneFile) {
  CommonOptions common;
  common.json = (dir_ / "result").string();
  CommandFiles files;
  files.writes("--csv", dir_ / "homes/../result");
  files.writes_common(common);
  EXPECT_THAT(error_of([&] { files.check(); }), AllOf(HasSubstr("--json"), HasSubstr("--csv")));
  common.json.clear();
  common.log_file = (dir_ / "twin.glb").string();
  CommandFiles logs;
  logs.reads("SCENE", dir_ / "room.glb");
  logs.writes_common(common);
  EXPECT_THAT(error_of([&] { logs.check(); }), AllOf(HasSubstr("--log-file"), HasSubstr("SCENE")));
}

TEST_F(CommandFilesTest, DevicesAreNobodys) {
  CommandFiles files;
  files.reads("--points", "/dev/null");
  files.writes("--csv", "/dev/null");
  files.writes("--json", "/dev/null");
  files.writes("--none", "");
  EXPECT_NO_THROW(files.check());
}

TEST_F(CommandFilesTest, WhatWasReadWithoutAFlagIsAnInput) {
  read_file(dir_ / "homes/dataset.json");
  CommandFiles files;
  files.writes("--out", dir_ / "homes/dataset.json");
  files.writes("--json", dir_ / "twin.glb");
  EXPECT_NO_THROW(files.check_what_was_read()) << "read before the command began";
  const MappedFile map(dir_ / "link.glb");
  EXPECT_THAT(error_of([&] { files.check_what_was_read(); }),
              AllOf(HasSubstr("--json"), HasSubstr("twin.glb")));
}

}  // namespace
}  // namespace lte
