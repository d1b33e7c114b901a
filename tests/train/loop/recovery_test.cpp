// A run goes on as if nothing had happened: after power cuts, kills, full disks and moves.
#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/locked_file.h"
#include "lte/base/safetensors.h"
#include "tests/train/run_fixture.h"
#include "tests/train/tool_process.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using test::expect_same_tensors;
using test::log_values;

/// Overwrites `count` bytes from `offset` on, as a failing disk would.
void overwrite(const fs::path& path, size_t offset, size_t count, char with) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(offset));
  const std::string bytes(count, with);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::vector<std::string> checkpoints_in(const fs::path& run) {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(run)) {
    const std::string name = file.path().filename().string();
    if (name.starts_with("checkpoint")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A run of eight steps, and the same stopped after seven: it has checkpoints of steps 7 and 6, and
/// of 4, the best one.
class Recovery : public test::RunFixture {
 protected:
  static void SetUpTestSuite() {
    RunFixture::SetUpTestSuite();
    runs_ = new test::TempDir;
    const auto config = [](const char* run) {
      return test::tiny_config(data_->path(), *runs_ / run);
    };
    train(config("straight"));
    train(config("stopped"), false, 7);
  }
  static void TearDownTestSuite() {
    delete runs_;
    RunFixture::TearDownTestSuite();
  }

  /// A fresh copy of the stopped run.
  fs::path stopped(const std::string& name) const {
    fs::copy(*runs_ / "stopped", dir_ / name, fs::copy_options::recursive);
    return dir_ / name;
  }

  /// Goes on with the run and compares all that it leaves with the uninterrupted one.
  void expect_recovery(const std::string& name) const {
    train(config(name), true);
    for (const char* file :
         {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors"}) {
      SCOPED_TRACE(file);
      expect_same_tensors(*runs_ / "straight" / file, dir_ / name / file);
    }
    EXPECT_EQ(log_values(*runs_ / "straight"), log_values(dir_ / name));
    EXPECT_EQ(read_file(*runs_ / "straight/config.yaml"), read_file(dir_ / name / "config.yaml"));
    const RunProgress a = read_checkpoint_header(checkpoint_path(*runs_ / "straight")).progress,
                      b = read_checkpoint_header(checkpoint_path(dir_ / name)).progress;
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.best_loss, b.best_loss);
    EXPECT_EQ(a.best_step, b.best_step);
  }

  static test::TempDir* runs_;
};
test::TempDir* Recovery::runs_ = nullptr;

TEST_F(Recovery, KeepsTheLastCheckpointsAndTheBest) {
  EXPECT_EQ(checkpoints_in(*runs_ / "stopped"),
            (std::vector<std::string>{"checkpoint.safetensors", "checkpoint_6.safetensors",
                                      "checkpoint_best.safetensors"}));
  const std::string often = "train: {steps: 6, checkpoint_every: 1, validate_every: 100, ";
  train(config("three", often + "keep_checkpoints: 3}\n"), false, 5);
  EXPECT_EQ(checkpoints_in(dir_ / "three"),
            (std::vector<std::string>{"checkpoint.safetensors", "checkpoint_3.safetensors",
                                      "checkpoint_4.safetensors"}));
  EXPECT_EQ(read_checkpoint_header(dir_ / "three/checkpoint_4.safetensors").progress.step, 4);
  train(config("one", often + "keep_checkpoints: 1}\n"), false, 5);
  EXPECT_EQ(checkpoints_in(dir_ / "one"), (std::vector<std::string>{"checkpoint.safetensors"}));
}

TEST_F(Recovery, TheCheckpointOfTheBestModelIsKept) {
  const RunProgress progress =
      read_checkpoint_header(best_checkpoint_path(*runs_ / "stopped")).progress;
  EXPECT_EQ(progress.step, 4);
  EXPECT_EQ(progress.best_step, 4);
  EXPECT_EQ(step_of_model(best_model_path(*runs_ / "stopped")), 4);
}

TEST_F(Recovery, ADamagedCheckpointGivesWayToTheOneBefore) {
  const auto whole = fs::file_size(*runs_ / "stopped/checkpoint.safetensors");
  const std::vector<std::pair<std::string, std::function<void(const fs::path&)>>> faults = {
      {"empty", [](const fs::path& file) { fs::resize_file(file, 0); }},
      {"half a length", [](const fs::path& file) { fs::resize_file(file, 5); }},
      {"half a header", [](const fs::path& file) { fs::resize_file(file, 300); }},
      {"half", [&](const fs::path& file) { fs::resize_file(file, whole / 2); }},
      {"a byte short", [&](const fs::path& file) { fs::resize_file(file, whole - 1); }},
      {"zeros", [&](const fs::path& file) { overwrite(file, 0, whole, '\0'); }},
      {"a tail of zeros", [&](const fs::path& file) { overwrite(file, whole - 4096, 4096, '\0'); }},
      {"another byte", [&](const fs::path& file) { overwrite(file, whole / 2, 1, '\x5a'); }},
      {"bad header", [](const fs::path& file) { overwrite(file, 20, 9, '{'); }},
      {"another file", [](const fs::path& file) {
         fs::copy(file.parent_path() / "model.safetensors", file,
                  fs::copy_options::overwrite_existing);
       }}};
  for (const auto& [name, damage] : faults) {
    SCOPED_TRACE(name);
    damage(stopped(name) / "checkpoint.safetensors");
    const std::string said = test::captured_stderr([&, run = name] { expect_recovery(run); });
    const size_t first = said.find("warning: ");
    ASSERT_NE(first, std::string::npos) << said;
    const std::string line = said.substr(first, said.find('\n', first) - first);
    EXPECT_NE(line.find(name + "/checkpoint.safetensors: "), std::string::npos) << line;
    EXPECT_NE(line.find(name + "/checkpoint_6.safetensors"), std::string::npos) << line;
  }
}

TEST_F(Recovery, TheBestCheckpointIsTheLastResort) {
  const fs::path run = stopped("run");
  fs::resize_file(run / "checkpoint.safetensors", 100);
  fs::resize_file(run / "checkpoint_6.safetensors", 100);
  expect_recovery("run");
  EXPECT_EQ(checkpoints_in(run), checkpoints_in(*runs_ / "straight"));
}

TEST_F(Recovery, WithoutAWholeCheckpointOneLineNamesThemAll) {
  const fs::path run = stopped("run");
  for (const std::string& name : checkpoints_in(run)) fs::resize_file(run / name, 100);
  test::expect_error([&] { train(config("run"), true); },
                     {"no checkpoint is whole", "checkpoint.safetensors: ",
                      "checkpoint_6.safetensors: ", "checkpoint_best.safetensors: "});
  try {
    train(config("run"), true);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

TEST_F(Recovery, ANewerFormatIsNoDamage) {
  const fs::path run = stopped("run");
  const std::string text = read_file(run / "checkpoint.safetensors");
  const size_t at = text.find("\"format_version\":\"2\"");
  ASSERT_NE(at, std::string::npos);
  overwrite(run / "checkpoint.safetensors", at + std::strlen("\"format_version\":\""), 1, '9');
  test::expect_error([&] { train(config("run"), true); },
                     {"checkpoint.safetensors", "format version 9", "update lte"});
}

TEST_F(Recovery, AnyFileCutAnywhere) {
  const std::vector<std::string> files = {"checkpoint.safetensors",
                                          "checkpoint_6.safetensors",
                                          "checkpoint_best.safetensors",
                                          "model.safetensors",
                                          "model_best.safetensors",
                                          "log.jsonl",
                                          "config.yaml"};
  int number = 0;
  for (const std::string& file : files) {
    const auto whole = fs::file_size(*runs_ / "stopped" / file);
    for (const double share : {0.0, 0.37, 0.99}) {
      const std::string name = "cut" + std::to_string(++number);
      SCOPED_TRACE(file + " cut at " + std::to_string(share));
      fs::resize_file(stopped(name) / file,
                      static_cast<uintmax_t>(share * static_cast<double>(whole)));
      expect_recovery(name);
      fs::remove_all(dir_ / name);
    }
  }
}

TEST_F(Recovery, AnyFileGone) {
  for (const char* file : {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors",
                           "log.jsonl", "config.yaml"}) {
    SCOPED_TRACE(file);
    fs::remove(stopped(file) / file);
    expect_recovery(file);
  }
}

TEST_F(Recovery, KilledBetweenTheRenamesItTakesTheLatest) {
  // Written under its own name and not renamed yet.
  const fs::path a = stopped("a");
  fs::rename(a / "checkpoint.safetensors", a / "checkpoint_7.safetensors");
  fs::rename(a / "checkpoint_6.safetensors", a / "checkpoint.safetensors");
  // The one before out of the way, the new one not yet in its place.
  const fs::path b = stopped("b");
  fs::rename(b / "checkpoint.safetensors", b / "checkpoint_7.safetensors");
  for (const char* name : {"a", "b"}) {
    EXPECT_EQ(Trainer(config(name), "", at::kCPU, true).run(1).step, 8) << name << " is at 7";
    EXPECT_EQ(checkpoints_in(dir_ / name),
              (std::vector<std::string>{"checkpoint.safetensors", "checkpoint_7.safetensors",
                                        "checkpoint_best.safetensors"}));
    test::expect_error([&] { train(config(name)); }, {"a run is there already"});
  }
}

TEST_F(Recovery, ADamagedBestModelIsMadeAgainAtOnce) {
  const fs::path run = stopped("run");
  fs::resize_file(run / "model_best.safetensors", 1000);
  const Trainer trainer(config("run"), "", at::kCPU, true);
  expect_same_tensors(*runs_ / "stopped/model_best.safetensors", run / "model_best.safetensors");
  EXPECT_EQ(SafetensorsFile(run / "model_best.safetensors").metadata("val_loss"),
            SafetensorsFile(*runs_ / "stopped/model_best.safetensors").metadata("val_loss"));
}

TEST_F(Recovery, ALostBestModelIsFoundAnew) {
  const fs::path run = stopped("run");
  fs::remove(run / "model_best.safetensors");
  fs::remove(run / "checkpoint_best.safetensors");
  const std::string said = test::captured_stderr([&] { train(config("run"), true); });
  EXPECT_NE(said.find("no checkpoint of step 4 is left"), std::string::npos) << said;
  EXPECT_EQ(step_of_model(run / "model_best.safetensors"), 8);
}

TEST_F(Recovery, ARunFolderMayBeMoved) {
  fs::create_directories(dir_ / "else/where");
  fs::rename(stopped("run"), dir_ / "else/where/moved");
  expect_recovery("else/where/moved");
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(Recovery, LeftoversOfKilledProcessesAreRemoved) {
  const fs::path run = stopped("run");
  std::ofstream(run / ".checkpoint_7.safetensors.tmp-4711-0-0") << "half";
  std::ofstream(run / "notes.txt") << "somebody's own";
  train(config("run"), true);
  EXPECT_FALSE(fs::exists(run / ".checkpoint_7.safetensors.tmp-4711-0-0"));
  EXPECT_TRUE(fs::exists(run / "notes.txt"));
}

TEST_F(Recovery, TwoProcessesDoNotTrainInOneDirectory) {
  const fs::path run = stopped("run");
  const LockedFile other(run / ".lock");
  test::expect_error([&] { train(config("run"), true); }, {run.string(), "another lte_train"});
}

TEST_F(Recovery, AverageMomentsAndProgressSurvive) {
  const SafetensorsFile file(*runs_ / "stopped/checkpoint.safetensors");
  const fs::path copy = dir_ / "copy.safetensors";
  const CheckpointHeader header = read_checkpoint_header(file.path());
  const nn::LightTransportModel model(header.model);
  Optimizer optimizer(config("run").train, model);
  load_checkpoint(file.path(), model, &optimizer);
  save_checkpoint(copy, model, optimizer, header.progress, header.config, *header.log);
  expect_same_tensors(*runs_ / "stopped/checkpoint.safetensors", copy);
  EXPECT_EQ(SafetensorsFile(copy).metadata("progress"), file.metadata("progress"));
  EXPECT_EQ(SafetensorsFile(copy).metadata(kChecksumKey), file.metadata(kChecksumKey));
  int averages = 0, apart = 0;
  for (const auto& [name, tensor] : file.tensors()) {
    if (!name.starts_with("average.")) continue;
    const TensorView& weight = file.at("model." + name.substr(std::strlen("average.")));
    apart += std::memcmp(tensor.data, weight.data, tensor.size_bytes()) != 0 ? 1 : 0;
    ++averages;
  }
  EXPECT_GT(averages, 10);
  EXPECT_GT(apart, averages / 2) << "the average is not the weights";
}

/// The program itself, where only a process of its own will do.
class RecoveryTool : public Recovery {
 protected:
  void SetUp() override {
    setenv("OMP_NUM_THREADS", "1", 1);
    std::ofstream(config_) << test::tiny_yaml(data_->path(), dir_ / "run");
  }
  int tool(std::vector<std::string> args, size_t file_limit = 0) {
    args.insert(args.begin(), {"--config", config_, "--quiet"});
    test::ToolProcess child(args, dir_ / "tool", {}, file_limit);
    const int status = child.wait();
    error_ = child.err();
    return status;
  }
  std::string config_ = (dir_ / "cfg.yaml").string(), error_;
};

TEST_F(RecoveryTool, AFullDiskEndsTheRunAndLeavesTheLastCheckpoint) {
  ASSERT_EQ(tool({"--stop-after", "3"}), 0) << error_;
  const fs::path run = dir_ / "run";
  const std::string before = read_file(run / "checkpoint.safetensors");
  // Room for the models, a third of a checkpoint, and for the log, but for no checkpoint more.
  EXPECT_EQ(tool({"--resume", "--set", "train.validate_every=100"}, before.size() - 1), 1);
  EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
  for (const char* part : {"checkpoint_6.safetensors", "cannot write", "the last checkpoint stays"})
    EXPECT_NE(error_.find(part), std::string::npos) << error_;
  EXPECT_EQ(read_file(run / "checkpoint.safetensors"), before);
  for (const auto& file : fs::directory_iterator(run))
    EXPECT_TRUE(temporary_of(file.path().filename().string()).empty()) << file.path();
  ASSERT_EQ(tool({"--resume"}), 0) << error_;
  for (const char* file : {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors"})
    expect_same_tensors(*runs_ / "straight" / file, run / file);
  EXPECT_EQ(log_values(*runs_ / "straight"), log_values(run));
}

TEST_F(RecoveryTool, ALogThatCannotBeWrittenEndsNoRun) {
  ASSERT_EQ(tool({"--stop-after", "3"}), 0) << error_;
  const fs::path log = dir_ / "run/log.jsonl";
  fs::remove(log);
  fs::create_symlink("/dev/full", log);  // no space is ever left there
  EXPECT_EQ(tool({"--resume"}), 0);
  EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 2) << error_;
  for (const char* part : {"log.jsonl", "No space left on device", "lines wait", "could not be"})
    EXPECT_NE(error_.find(part), std::string::npos) << error_;
  fs::remove(log);
  ASSERT_EQ(tool({"--resume"}), 0) << error_;
  EXPECT_EQ(log_values(*runs_ / "straight"), log_values(dir_ / "run"));
}

/// No key of the configuration changes unsaid.
TEST_F(RecoveryTool, AResumedRunSaysWhichKeysChange) {
  const auto resumed = [&](std::vector<std::string> args) {
    args.insert(args.end(), {"--resume", "--stop-after", "1"});
    test::ToolProcess child(args, dir_ / "tool");
    EXPECT_EQ(child.wait(), 0) << child.err();
    std::vector<std::string> changes;
    std::istringstream lines(child.err());
    const std::string mark = "changed from here on: ";
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with(mark)) changes.push_back(line.substr(mark.size()));
    return changes;
  };
  using Lines = std::vector<std::string>;
  const std::string run = (dir_ / "run").string();
  ASSERT_EQ(tool({"--stop-after", "1", "--set", "train.steps=20", "--set", "data.cache_mb=77"}), 0)
      << error_;
  EXPECT_EQ(resumed({"--out", run}), Lines{}) << "its own configuration is taken";
  EXPECT_EQ(resumed({"--out", run, "--set", "train.steps=30"}), Lines{"train.steps: 20 -> 30"});
  const Lines reset = resumed({"--config", config_});
  ASSERT_EQ(reset.size(), 2u);
  EXPECT_EQ(reset[0], "train.steps: 30 -> 8");
  EXPECT_TRUE(reset[1].starts_with("data.cache_mb: 77 -> ")) << reset[1];
  EXPECT_EQ(Config::load(dir_ / "run/config.yaml").to_yaml().find("cache_mb: 77"),
            std::string::npos);
  test::ToolProcess refused({"--out", run, "--resume", "--set", "model.channels=64", "--quiet"},
                            dir_ / "tool");
  EXPECT_EQ(refused.wait(), 1);
  EXPECT_NE(refused.err().find("model.channels"), std::string::npos) << refused.err();
}

TEST_F(RecoveryTool, KilledAgainAndAgainItEndsAsIfNothingHadBeen) {
  const std::vector<std::string> steps = {"--set", "train.steps=60", "--set",
                                          "train.keep_checkpoints=3"};
  std::vector<std::string> args = {"--config", config_, "--quiet"};
  args.insert(args.end(), steps.begin(), steps.end());
  for (const size_t lines : {4, 12, 19, 30}) {
    std::vector<std::string> session = args;
    if (lines > 4) session.push_back("--resume");
    test::ToolProcess child(session, dir_ / "tool");
    for (int i = 0; i < 3000 && test::lines_of(dir_ / "run/log.jsonl").size() < lines; ++i)
      usleep(10'000);
    kill(child.id(), SIGKILL);
    child.wait();
  }
  std::vector<std::string> resumed = steps, straight = steps;
  resumed.push_back("--resume");
  ASSERT_EQ(tool(resumed), 0) << error_;
  straight.insert(straight.end(), {"--out", (dir_ / "straight").string()});
  ASSERT_EQ(tool(straight), 0) << error_;
  for (const char* file : {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors"})
    expect_same_tensors(dir_ / "straight" / file, dir_ / "run" / file);
  EXPECT_EQ(log_values(dir_ / "straight"), log_values(dir_ / "run"));
}

}  // namespace
}  // namespace lte::train
