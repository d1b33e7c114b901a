// Runs of several processes over loopback: the same weights as one process, and what happens when
// one of them dies, hangs or gives up.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "lte/base/safetensors.h"
#include "tests/train/free_port.h"
#include "tests/train/support.h"
#include "tests/train/tool_process.h"
#include "train/checkpoint/checkpoint.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using Args = std::vector<std::string>;
using test::ToolProcess;

class Distributed : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("OMP_NUM_THREADS", "1", 1);
    data_ = new test::TempDir;
    test::write_dataset(data_->path(), 5, 1);
  }
  static void TearDownTestSuite() { delete data_; }

  void SetUp() override {
    std::ofstream(dir_ / "base.yaml") << test::tiny_yaml(data_->path(), dir_ / "run");
    std::ofstream(config_) << "parent: base.yaml\n"
                              "train: {steps: 20, scenes_per_step: 3, learning_rate: 2.0e-4, "
                              "checkpoint_every: 5, validate_every: 10}\n";
  }

  /// One process for each rank.
  std::vector<ToolProcess> start(int size, const Args& more) const {
    Args args = {"--config", config_, "--quiet"};
    args.insert(args.end(), more.begin(), more.end());
    const std::string port = std::to_string(test::free_port());
    std::vector<ToolProcess> processes;
    for (int rank = 0; rank < size; ++rank) {
      processes.emplace_back(
          args, dir_ / ("rank" + std::to_string(rank)),
          std::map<std::string, std::string>{{"RANK", std::to_string(rank)},
                                             {"LOCAL_RANK", std::to_string(rank)},
                                             {"WORLD_SIZE", std::to_string(size)},
                                             {"MASTER_ADDR", "127.0.0.1"},
                                             {"MASTER_PORT", port}});
    }
    return processes;
  }

  void run(int size, const Args& more) const {
    for (ToolProcess& process : start(size, more)) EXPECT_EQ(process.wait(), 0) << process.err();
  }

  void await_step(int64_t step) const {
    const fs::path path = checkpoint_path(dir_ / "run");
    for (int i = 0; i < 3000; ++i) {
      if (fs::exists(path) && read_checkpoint_header(path).progress.step >= step) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no checkpoint at step " << step;
  }

  /// Largest difference of a weight between two runs.
  double difference(const std::string& a, const std::string& b) const {
    const SafetensorsFile first(checkpoint_path(dir_ / a)), second(checkpoint_path(dir_ / b));
    double apart = 0;
    for (const auto& [name, tensor] : first.tensors()) {
      if (name.rfind("model.", 0) != 0) continue;
      const auto *x = static_cast<const float*>(static_cast<const void*>(tensor.data)),
                 *y = static_cast<const float*>(static_cast<const void*>(second.at(name).data));
      for (size_t i = 0; i < tensor.size_bytes() / sizeof(float); ++i)
        apart = std::max<double>(apart, std::fabs(x[i] - y[i]));
    }
    return apart;
  }

  /// Lines of the log with the norms of the whole gradient and of each module.
  static void expect_same_norms(const fs::path& a, const fs::path& b) {
    const auto first = test::lines_of(a / "log.jsonl"), second = test::lines_of(b / "log.jsonl");
    ASSERT_EQ(first.size(), second.size());
    int compared = 0;
    for (size_t i = 0; i < first.size(); ++i) {
      const auto one = nlohmann::json::parse(first[i]), other = nlohmann::json::parse(second[i]);
      for (const auto& [name, value] : one.items()) {
        if (!name.starts_with("grad_norm")) continue;
        EXPECT_NEAR(other.at(name).get<double>(), value.get<double>(),
                    1e-3 * value.get<double>() + 1e-9)
            << name;
        ++compared;
      }
    }
    EXPECT_GT(compared, 20);
  }

  test::TempDir dir_;
  std::string config_ = (dir_ / "cfg.yaml").string();
  static test::TempDir* data_;
};
test::TempDir* Distributed::data_ = nullptr;

TEST_F(Distributed, TwoAndThreeProcessesLearnWhatOneDoes) {
  run(1, {"--out", (dir_ / "one").string()});
  run(1, {"--out", (dir_ / "start").string(), "--stop-after", "1"});
  EXPECT_GT(difference("one", "start"), 1e-3);
  for (const int size : {2, 3}) {
    const std::string name = "with" + std::to_string(size);
    run(size, {"--out", (dir_ / name).string()});
    EXPECT_LT(difference("one", name), 1e-6) << size << " processes";
    // Rank 0 alone has written, and its log is that of the whole.
    expect_same_norms(dir_ / "one", dir_ / name);
  }
}

TEST_F(Distributed, GoesOnWithAnotherNumberOfProcesses) {
  run(1, {"--out", (dir_ / "one").string()});
  run(3, {"--stop-after", "7"});
  run(2, {"--resume", "--stop-after", "6"});
  run(1, {"--resume"});
  EXPECT_LT(difference("one", "run"), 1e-6);
}

TEST_F(Distributed, AProcessThatDiesEndsTheOthersWithItsName) {
  std::vector<ToolProcess> processes = start(3, {"--set", "train.steps=100000"});
  await_step(5);
  kill(processes[1].id(), SIGKILL);
  const std::string victim = "process " + std::to_string(processes[1].id());
  EXPECT_EQ(processes[1].wait(), -SIGKILL);
  for (const int rank : {0, 2}) {
    EXPECT_EQ(processes[rank].wait(), 1);
    const std::string error = processes[rank].err();
    EXPECT_NE(error.find("rank 1 (host "), std::string::npos) << error;
    EXPECT_NE(error.find(victim), std::string::npos) << error;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  }
  const int64_t step = read_checkpoint_header(checkpoint_path(dir_ / "run")).progress.step;
  run(2, {"--resume", "--set", "train.steps=100000", "--stop-after", "2"});
  EXPECT_EQ(read_checkpoint_header(checkpoint_path(dir_ / "run")).progress.step, step + 2);
}

TEST_F(Distributed, AProcessThatHangsEndsTheOthersWithItsName) {
  for (const int victim : {1, 0}) {
    fs::remove_all(dir_ / "run");
    std::vector<ToolProcess> processes =
        start(2, {"--set", "train.steps=100000", "--set", "train.timeout_s=2"});
    await_step(5);
    kill(processes[victim].id(), SIGSTOP);
    EXPECT_EQ(processes[1 - victim].wait(), 1);
    const std::string error = processes[1 - victim].err();
    EXPECT_NE(error.find("rank " + std::to_string(victim) + " ("), std::string::npos) << error;
    EXPECT_NE(error.find("hangs"), std::string::npos) << error;
  }
}

TEST_F(Distributed, WithoutRankZeroTheOthersEnd) {
  std::vector<ToolProcess> processes = start(2, {"--set", "train.steps=100000"});
  await_step(5);
  kill(processes[0].id(), SIGKILL);
  EXPECT_EQ(processes[1].wait(), 1);
  const std::string error = processes[1].err();
  EXPECT_NE(error.find("rank 0 (127.0.0.1:"), std::string::npos) << error;
}

TEST_F(Distributed, ASignalToOneEndsAllAfterTheSameStep) {
  std::vector<ToolProcess> processes = start(2, {"--set", "train.steps=100000"});
  await_step(5);
  kill(processes[1].id(), SIGTERM);
  for (ToolProcess& process : processes) EXPECT_EQ(process.wait(), 128 + SIGTERM) << process.err();
  EXPECT_GE(read_checkpoint_header(checkpoint_path(dir_ / "run")).progress.step, 5);
}

TEST_F(Distributed, AProcessThatNeverComesIsNamed) {
  ToolProcess lonely({"--config", config_, "--quiet", "--set", "train.timeout_s=2"},
                     dir_ / "lonely",
                     {{"RANK", "0"},
                      {"WORLD_SIZE", "2"},
                      {"MASTER_ADDR", "127.0.0.1"},
                      {"MASTER_PORT", std::to_string(test::free_port())}});
  EXPECT_EQ(lonely.wait(), 1);
  EXPECT_NE(lonely.err().find("rank 1 never came"), std::string::npos) << lonely.err();
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(Distributed, MoreProcessesThanScenesAStepAreRefused) {
  for (ToolProcess& process : start(2, {"--set", "train.scenes_per_step=1"})) {
    EXPECT_EQ(process.wait(), 1);
    EXPECT_NE(process.err().find("train.scenes_per_step"), std::string::npos) << process.err();
  }
}

TEST_F(Distributed, BadScenesAreSkippedAlikeByAll) {
  test::TempDir bad;
  test::write_dataset(bad.path(), 6, 1);
  for (const char* scene : {"room1", "room4"})
    fs::resize_file(data::scene_path(bad.path(), scene), 1000);
  const Args skip = {"--set", "data.on_bad_scene=skip", "--set", "data.root=" + bad.path().string(),
                     "--out"};
  const auto to = [&](const std::string& name) {
    Args args = skip;
    args.push_back((dir_ / name).string());
    return args;
  };
  run(1, to("one"));
  std::vector<ToolProcess> processes = start(2, to("two"));
  for (ToolProcess& process : processes) EXPECT_EQ(process.wait(), 0) << process.err();
  EXPECT_LT(difference("one", "two"), 1e-6);
  EXPECT_NE(processes[0].err().find("2 of 6 training scenes and 0 validation scenes"),
            std::string::npos)
      << processes[0].err();
  EXPECT_EQ(processes[1].err().find("of 6 training scenes"), std::string::npos);
}

TEST_F(Distributed, ADataSetThatDiffersIsRefused) {
  test::TempDir other;
  test::write_dataset(other.path(), 3, 1);
  const std::string port = std::to_string(test::free_port());
  const auto variables = [&](const char* rank) {
    return std::map<std::string, std::string>{
        {"RANK", rank}, {"WORLD_SIZE", "2"}, {"MASTER_PORT", port}};
  };
  ToolProcess leader({"--config", config_, "--quiet"}, dir_ / "leader", variables("0"));
  ToolProcess follower(
      {"--config", config_, "--quiet", "--set", "data.root=" + other.path().string()},
      dir_ / "follower", variables("1"));
  EXPECT_EQ(follower.wait(), 1);
  EXPECT_NE(follower.err().find("the training split of rank 1 is not that of rank 0"),
            std::string::npos)
      << follower.err();
  EXPECT_EQ(leader.wait(), 1);
}

}  // namespace
}  // namespace lte::train
