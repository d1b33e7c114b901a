// The flags of lte_train in this process: no output replaces an input, no number is another, and a
// start that fails leaves nothing.
#include <filesystem>
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/log.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/train/support.h"
#include "train/command/train_command.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using test::expect_one_line;
using test::folder_files;

/// The command line of lte_train as train/main.cpp has it.
struct Tool {
  CLI::App app{"", "lte_train"};
  CommonOptions common;
  RunOptions options;

  Tool() {
    add_run_options(app, &options);
    add_common_options(app, &common);
  }
};

class TrainFiles : public testing::Test {
 protected:
  TrainFiles() : before_(fs::current_path()) {
    fs::current_path(dir_.path());
    test::write_dataset("rooms", 2, 1);
    test::write_text("cfg.yaml", test::tiny_yaml("rooms", "run"));
    test::write_text("child.yaml", "parent: cfg.yaml\n");
    test::write_text("weights.safetensors", "");
    fs::create_directories("old");
    test::write_text("old/config.yaml", "train: {steps: 5}\n");
    test::write_text("old/log.jsonl", "{\"step\": 1, \"loss\": 2}\n");
    fs::create_symlink("old/config.yaml", "link.yaml");
  }
  ~TrainFiles() override {
    fs::current_path(before_);
    set_log_level(LogLevel::Info);
  }

  static test::CommandOutcome run_line(const std::string& line) {
    Tool tool;
    std::istringstream words(line);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    return test::run_command(tool.app, arguments, [&tool] {
      apply_common_options(tool.common);
      tool.options.json = tool.common.json;
      tool.options.log_file = tool.common.log_file;
      run(tool.options);
    });
  }

  test::TempDir dir_;
  fs::path before_;
};

TEST_F(TrainFiles, NoOutputReplacesAnInputOrAnotherOutput) {
  struct Case {
    const char *line, *first, *second;
  };
  const Case cases[] = {
      {"--config cfg.yaml --json cfg.yaml", "--json", "--config"},
      {"--config cfg.yaml --log-file cfg.yaml", "--log-file", "--config"},
      {"--config cfg.yaml --json rooms/dataset.json", "--json", "data.root"},
      {"--config cfg.yaml --json rooms/scenes/room0.safetensors", "--json", "data.root"},
      {"--config cfg.yaml --out rooms", "--out", "data.root"},
      {"--config cfg.yaml --json run/log.jsonl", "--json", "--out"},
      {"--config cfg.yaml --dry-run --json cfg.yaml", "--json", "--config"},
      {"--config cfg.yaml --init-weights weights.safetensors --json weights.safetensors", "--json",
       "--init-weights"},
      {"--config cfg.yaml --init-weights w/model.safetensors --out w", "--out", "--init-weights"},
      {"--config old/config.yaml --out old --set data.root=rooms", "--out", "--config"},
      {"--config link.yaml --out old --set data.root=rooms", "--out", "--config"},
      {"--config cfg.yaml --json both --log-file both", "--log-file", "--json"},
  };
  const auto before = folder_files(".");
  for (const Case& c : cases) {
    SCOPED_TRACE(c.line);
    expect_one_line(run_line(c.line), 1, {c.first, c.second, "name another file"});
    auto after = folder_files(".");
    after.erase("both");  // --log-file is opened first
    EXPECT_EQ(after, before);
  }
  expect_one_line(run_line("--config child.yaml --json cfg.yaml"), 1, {"--json", "input"});
}

TEST_F(TrainFiles, AFirstStartThatFailsLeavesNothing) {
  fs::resize_file(data::scene_path("rooms", "room2"), 100);  // that of validation
  expect_one_line(run_line("--config cfg.yaml --quiet"), 1, {"room2.safetensors"});
  EXPECT_FALSE(fs::exists("run"));
  fs::create_directories("mine");
  test::write_text("mine/notes.txt", "somebody's own");
  expect_one_line(run_line("--config cfg.yaml --quiet --out mine"), 1, {"room2.safetensors"});
  EXPECT_EQ(std::distance(fs::directory_iterator("mine"), {}), 1);
}

TEST_F(TrainFiles, ResumingWithoutAConfigurationNeedsTheRun) {
  expect_one_line(run_line("--resume"), 2, {"--config", "--out"});
  expect_one_line(run_line(""), 2, {"--config"});
  expect_one_line(run_line("--resume --out nowhere"), 1, {"nowhere/config.yaml"});
  EXPECT_FALSE(fs::exists("nowhere"));
}

TEST(TrainFlags, WhatIsNoNumberIsRefusedByEveryFlag) {
  test::expect_numbers_refused(
      [](CLI::App& app) {
        static RunOptions options;
        static CommonOptions common;
        add_run_options(app, &options);
        add_common_options(app, &common);
      },
      {"--seed", "--threads", "--stop-after"});
  Tool tool;
  expect_one_line(test::run_command(tool.app, {"--find-lr=99999999999999999999999"}), 2,
                  {"--find-lr"});
}

}  // namespace
}  // namespace lte::train
