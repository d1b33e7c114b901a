// The flags of lte_datagen in this process: no output replaces an input, no number is another.
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/commands/bake_command.h"
#include "datagen/commands/generate_command.h"
#include "datagen/commands/info_command.h"
#include "datagen/commands/probe_command.h"
#include "lte/base/log.h"
#include "lte/scene/export.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"

namespace lte::datagen::test {
namespace {

namespace fs = std::filesystem;
using lte::test::CommandOutcome;
using lte::test::expect_one_line;
using lte::test::folder_files;

void declare(CLI::App& app, CommandBody* body) {
  app.require_subcommand(1);
  add_generate_command(app, body);
  add_bake_command(app, body);
  add_probe_command(app, body);
  add_info_command(app, body);
}

class DatagenFiles : public data::test::Folder {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    fs::current_path(folder_);
    scene::write_glb("room.glb", furnace(2, 0.5f));
    write_file("tiny.yaml", to_yaml(tiny_config()));
    write_file("child.yaml", "parent: tiny.yaml\n");
    write_file("points.csv", "px,py,pz,nx,ny,nz\n0.5,0,0.5,0,1,0\n");
    write_file("red.mtl", "newmtl red\nKd 1 0 0\n");
    write_file("room.obj", "mtllib red.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fs::create_symlink("room.glb", "link.glb");
    fs::create_hard_link("points.csv", "twin.csv");
    ASSERT_EQ(run("generate --config tiny.yaml --out set --scenes 1 --quiet").code, 0);
  }
  void TearDown() override {
    fs::current_path(before_);
    set_log_level(LogLevel::Info);
  }

  /// Runs a command line whose words have no blanks in them.
  static CommandOutcome run(const std::string& line) {
    CLI::App app{"", "lte_datagen"};
    CommandBody body;
    declare(app, &body);
    std::istringstream words(line);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    return lte::test::run_command(app, arguments, [&body] { body(); });
  }

  fs::path before_;
};

TEST_F(DatagenFiles, NoOutputReplacesAnInputOrAnotherOutput) {
  struct Case {
    const char *line, *first, *second;
  };
  const Case cases[] = {
      {"bake room.glb --out room.glb", "--out", "SCENE"},
      {"bake room.glb --out link.glb", "--out", "SCENE"},
      {"bake link.glb --out ./room.glb", "--out", "SCENE"},
      {"bake room.glb --out a.safetensors --json room.glb", "--json", "SCENE"},
      {"bake room.glb --out a.safetensors --log-file room.glb", "--log-file", "SCENE"},
      {"bake room.glb --out a.safetensors --json a.safetensors", "--json", "--out"},
      {"bake room.glb --out a.safetensors --environment sky.exr --json sky.exr", "--json",
       "--environment"},
      {"bake room.glb --out room.glb --validate-only", "--out", "SCENE"},
      {"probe room.glb --points points.csv --out points.csv", "--out", "--points"},
      {"probe room.glb --points points.csv --out twin.csv", "--out", "--points"},
      {"probe room.glb --points points.csv --out room.glb", "--out", "SCENE"},
      {"probe room.glb --points points.csv --out b.csv --json b.csv", "--json", "--out"},
      {"info room.glb --json room.glb", "--json", "SCENE"},
      {"info set --json set/dataset.json", "--json", "PATH"},
      {"info set --json set/scenes/box_00000.safetensors", "--json", "PATH"},
      {"generate --config tiny.yaml --out b --json tiny.yaml", "--json", "--config"},
      {"generate --config set/config.yaml --out set", "--out", "--config"},
      {"generate --config tiny.yaml --out b --json b/dataset.json", "--json", "--out"},
      {"generate --out set --resume --json set/config.yaml", "--json", "--out"},
      {"generate --out set --merge --json set/dataset.json", "--json", "--out"},
  };
  const auto before = folder_files(".");
  for (const Case& c : cases) {
    SCOPED_TRACE(c.line);
    expect_one_line(run(c.line), 1, {c.first, c.second, "name another file"});
    EXPECT_EQ(folder_files("."), before);
  }
}

TEST_F(DatagenFiles, WhatCannotBeWrittenIsRefusedBeforeTheWork) {
  fs::create_directory("folder");
  const auto before = folder_files(".");
  const std::string bake = "bake room.glb --queries 1000 --rays 64 --out ";
  const std::string probe = "probe room.glb --points points.csv --rays 64 --out ";
  for (const std::string& work : {bake, probe}) {
    SCOPED_TRACE(work);
    expect_one_line(run(work + "folder"), 1, {"folder", "cannot be written", "is a folder"});
    expect_one_line(run(work + "none/a.out"), 1, {"none/a.out", "cannot be written"});
    expect_one_line(run(work + "points.csv/a.out"), 1, {"points.csv/a.out", "cannot be written"});
    expect_one_line(run(work + "a.out --json folder"), 1, {"folder", "cannot be written"});
    EXPECT_EQ(folder_files("."), before);
  }
}

TEST_F(DatagenFiles, FilesThatAnInputNamesAreInputs) {
  const auto before = folder_files(".");
  for (const std::string line :
       {"bake room.obj --environment 1,1,1 --quiet --out red.mtl", "info room.obj --json red.mtl",
        "generate --config child.yaml --out b --json tiny.yaml"}) {
    SCOPED_TRACE(line);
    expect_one_line(run(line), 1, {line.starts_with("bake") ? "--out" : "--json", "input"});
    EXPECT_EQ(folder_files("."), before);
  }
}

TEST_F(DatagenFiles, OtherFilesAreWritten) {
  EXPECT_EQ(run("info set --json set/notes.json").code, 0);
  EXPECT_EQ(run("info room.glb --json /dev/null").code, 0);
  EXPECT_EQ(run("generate --config set/config.yaml --out set --resume --quiet").code, 0);
  EXPECT_EQ(run("probe room.glb --points points.csv --out b.csv --rays 8 --quiet").code, 0);
}

TEST(DatagenFlags, WhatIsNoNumberIsRefusedByEveryFlag) {
  lte::test::expect_numbers_refused(
      [](CLI::App& app) {
        static CommandBody body;
        declare(app, &body);
      },
      {"--threads", "--seed", "--rays", "--target-error", "--scenes", "--environment-turn",
       "--queries", "--incident-points"});
}

}  // namespace
}  // namespace lte::datagen::test
