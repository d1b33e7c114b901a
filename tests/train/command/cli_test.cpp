// The program itself: exit codes, what it prints and leaves behind, signals.
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "tests/train/support.h"
#include "tests/train/tool_process.h"
#include "train/checkpoint/checkpoint.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using Args = std::vector<std::string>;

struct Outcome {
  int status = 0;
  std::string out, err;
};

class TrainTool : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("OMP_NUM_THREADS", "1", 1);  // of the tool: the matrices are tiny
    data_ = new test::TempDir;
    test::write_dataset(data_->path(), 2, 1);
  }
  static void TearDownTestSuite() { delete data_; }

  void SetUp() override { std::ofstream(config_) << test::tiny_yaml(data_->path(), dir_ / "run"); }

  test::ToolProcess start(const Args& args) const { return {args, dir_ / "tool"}; }

  Outcome tool(const Args& args) const {
    test::ToolProcess child = start(args);
    const int status = child.wait();
    return {status, child.out(), child.err()};
  }

  /// Runs until the log has `lines` lines, or half a minute.
  void await_log(size_t lines) const {
    for (int i = 0; i < 3000 && test::lines_of(dir_ / "run/log.jsonl").size() < lines; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  void expect_failure(const Args& args, int status, const std::vector<std::string>& parts) const {
    Args quiet = args;
    quiet.push_back("--quiet");  // leaves warnings and the error
    const Outcome outcome = tool(quiet);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& part : parts) {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "lacks: " << part;
    }
  }

  test::TempDir dir_;
  std::string config_ = (dir_ / "cfg.yaml").string();
  static test::TempDir* data_;
};
test::TempDir* TrainTool::data_ = nullptr;

TEST_F(TrainTool, TrainsAndReports) {
  const Outcome outcome =
      tool({"--config", config_, "--json", (dir_ / "out.json").string(), "--set", "train.steps=4"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("device: cpu"), std::string::npos);
  EXPECT_NE(outcome.out.find("model.safetensors: 4 steps"), std::string::npos);
  const auto json = nlohmann::json::parse(read_file(dir_ / "out.json"));
  EXPECT_EQ(json.at("step"), 4);
  EXPECT_EQ(json.at("finished"), true);
  EXPECT_TRUE(json.at("val_loss").is_number());
  for (const char* file : {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors",
                           "log.jsonl", "config.yaml"}) {
    EXPECT_TRUE(fs::exists(dir_ / "run" / file)) << file;
  }
}

TEST_F(TrainTool, SeedAndOutBeatTheFile) {
  const Outcome outcome = tool({"--config", config_, "--seed", "77", "--out",
                                (dir_ / "else: where").string(), "--stop-after", "1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_checkpoint_header(checkpoint_path(dir_ / "else: where")).progress.seed, 77u);
}

TEST_F(TrainTool, PrintConfigCanBeReadBack) {
  const Outcome outcome = tool({"--config", config_, "--set", "train.steps=4", "--print-config"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(TrainConfig::read(Config::parse(outcome.out, "printed")).train.steps, 4);
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(TrainTool, DryRunNeedsNoData) {
  const std::string json = (dir_ / "dry.json").string();
  const Outcome outcome =
      tool({"--config", config_, "--set", "data.root=/nonexistent", "--dry-run", "--json", json});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(nlohmann::json::parse(read_file(json)).at("parameters").at("total").get<int64_t>(), 0);
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(TrainTool, ValidateOnlyChecksEveryScene) {
  const Outcome outcome = tool({"--config", config_, "--validate-only"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("2 scenes to train on, 1 to validate on"), std::string::npos)
      << outcome.out;
  const test::TempDir bad;
  test::write_dataset(bad.path(), 1, 1);
  fs::resize_file(data::scene_path(bad.path(), "room1"), 1000);
  expect_failure({"--config", config_, "--set", "data.root=" + bad.path().string(),
                  "--validate-only", "--quiet"},
                 1, {"room1.safetensors"});
}

TEST_F(TrainTool, WrongUsageIsTwo) {
  expect_failure({}, 2, {"--config"});
  expect_failure({"--config", config_, "--resum"}, 2, {"--resum", "--resume"});
  expect_failure({"--config", config_, "--device", "tpu"}, 2, {"--device"});
  expect_failure({"--config", config_, "--seed", "x"}, 2, {"--seed"});
  expect_failure({"--config", config_, "--seed", "-1"}, 2, {"--seed"});
  expect_failure({"nonsense", "--help"}, 2, {"unknown command", "health"});
  expect_failure({"--config", config_, "--dry-run", "--resume"}, 2, {"--dry-run"});
}

TEST_F(TrainTool, BadInputIsOneAndOneLine) {
  expect_failure({"--config", "/nonexistent.yaml"}, 1, {"/nonexistent.yaml"});
  expect_failure({"--config", config_, "--set", "train.step=4"}, 1, {"train.step", "train.steps"});
  expect_failure({"--config", config_, "--set", "train.steps=four"}, 1, {"train.steps", "four"});
  expect_failure({"--config", config_, "--set", "data.root=/nonexistent"}, 1, {"/nonexistent"});
  expect_failure({"--config", config_, "--resume"}, 1, {"nothing to resume"});
  expect_failure({"--config", config_, "--out", "/proc/run"}, 1, {"/proc/run"});
  expect_failure({"--config", config_, "--stop-after", "1", "--json", "/nonexistent/out.json"}, 1,
                 {"/nonexistent/out.json"});
}

TEST_F(TrainTool, CudaIsNeverReplacedSilently) {
  const Outcome outcome = tool({"--config", config_, "--device", "cuda", "--stop-after", "1"});
  if (outcome.status == 0) {
    EXPECT_NE(outcome.err.find("device: cuda"), std::string::npos);
    return;
  }
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("--device cuda: "), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(TrainTool, ASignalFinishesTheStepAndLeavesACheckpoint) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(dir_ / "run");
    test::ToolProcess child =
        start({"--config", config_, "--quiet", "--set", "train.steps=1000000"});
    await_log(2);
    kill(child.id(), signal);
    EXPECT_EQ(child.wait(), 128 + signal);
    const int64_t step = read_checkpoint_header(checkpoint_path(dir_ / "run")).progress.step;
    EXPECT_GE(step, 4);
    EXPECT_TRUE(fs::exists(model_path(dir_ / "run")));
    const Outcome resumed = tool({"--config", config_, "--resume", "--quiet", "--set",
                                  "train.steps=1000000", "--stop-after", "1"});
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(read_checkpoint_header(checkpoint_path(dir_ / "run")).progress.step, step + 1);
  }
}

TEST_F(TrainTool, KilledOutrightItGoesOnFromTheLastCheckpoint) {
  const Args args = {"--config", config_, "--quiet", "--set", "train.steps=30"};
  test::ToolProcess child = start(args);
  await_log(4);
  kill(child.id(), SIGKILL);
  child.wait();
  Args resume = args;
  resume.push_back("--resume");
  const Outcome resumed = tool(resume);
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  Args straight = args;
  straight.insert(straight.end(), {"--out", (dir_ / "straight").string()});
  ASSERT_EQ(tool(straight).status, 0);
  const SafetensorsFile a(model_path(dir_ / "run")), b(model_path(dir_ / "straight"));
  for (const auto& [name, tensor] : a.tensors()) {
    EXPECT_EQ(std::memcmp(tensor.data, b.at(name).data, tensor.size_bytes()), 0) << name;
  }
}

}  // namespace
}  // namespace lte::train
