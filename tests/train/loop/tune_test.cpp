// The sweep of learning rates and the overfitting test.
#include <cmath>
#include <fstream>

#include "lte/base/file.h"
#include "tests/train/run_fixture.h"
#include "tests/train/tool_process.h"
#include "train/loop/overfit.h"
#include "train/loop/rate_sweep.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

/// A loss that falls around `steep`, is lowest at 1e-2 and then grows.
std::vector<RatePoint> curve(double steep) {
  std::vector<RatePoint> points;
  for (int i = 0; i <= 120; ++i) {
    RatePoint point;
    point.rate = std::pow(10, -6 + 0.05 * i);
    const double x = std::log10(point.rate);
    point.loss = 1 - 0.5 / (1 + std::exp(-6 * (x - std::log10(steep)))) +
                 (x > -2 ? 0.4 * (x + 2) * (x + 2) : 0.01 * (-2 - x));
    point.smoothed = point.loss;
    points.push_back(point);
  }
  return points;
}

TEST(RateSweep, FindsTheSteepestFallAndTheLowestPoint) {
  const RateSweep sweep = read_sweep(curve(3e-4), true);
  EXPECT_NEAR(std::log10(sweep.steepest), std::log10(3e-4), 0.1);
  EXPECT_NEAR(std::log10(sweep.lowest), -2, 0.1);
  EXPECT_EQ(sweep.suggestion, sweep.steepest);
  EXPECT_TRUE(sweep.diverged);
}

TEST(RateSweep, StaysATenthBelowTheLowestPoint) {
  const RateSweep sweep = read_sweep(curve(5e-3), false);
  EXPECT_LT(sweep.lowest / 10, sweep.steepest);
  EXPECT_EQ(sweep.suggestion, sweep.lowest / 10);
}

TEST(RateSweep, OfALossThatOnlyGrowsIsTheFirstRateADecadeDown) {
  std::vector<RatePoint> points;
  for (int i = 0; i < 30; ++i) points.push_back({std::pow(10, -4 + 0.1 * i), 1.0 + i, 1.0 + i});
  const RateSweep sweep = read_sweep(points, false);
  EXPECT_EQ(sweep.lowest, points[0].rate);
  EXPECT_EQ(sweep.suggestion, points[0].rate / 10);
  test::expect_error([] { read_sweep({RatePoint{1e-6, 1, 1}}, true); }, {"lowest rate"});
}

class Tune : public test::RunFixture {
 protected:
  /// Runs the program; its standard error is error_ afterwards.
  int tool(std::vector<std::string> args) {
    const std::string yaml = (dir_ / "cfg.yaml").string();
    std::ofstream(yaml) << test::tiny_yaml(data_->path(), dir_ / "run");
    args.insert(args.begin(), {"--config", yaml, "--quiet"});
    test::ToolProcess child(args, dir_ / "tool");
    const int status = child.wait();
    out_ = child.out();
    error_ = child.err();
    return status;
  }
  std::string out_, error_;
};

TEST_F(Tune, ASweepRisesByEqualFactorsAndIsTheSameEveryTime) {
  const RateSweep a = sweep_rates(config("run"), at::kCPU, 40);
  const RateSweep b = sweep_rates(config("run"), at::kCPU, 40);
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_GT(a.points.size(), 20u);
  EXPECT_EQ(a.points[0].rate, kLowestRate);
  const double factor = std::pow(kHighestRate / kLowestRate, 1.0 / 39);
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].loss, b.points[i].loss);
    if (i == 0) continue;
    EXPECT_NEAR(a.points[i].rate / a.points[i - 1].rate, factor, 1e-9);
  }
  EXPECT_GT(a.suggestion, kLowestRate);
  EXPECT_LT(a.suggestion, 0.1);
  EXPECT_FALSE(fs::exists(dir_ / "run")) << "it writes nothing by itself";
}

TEST_F(Tune, ASweepMayStartFromTrainedWeights) {
  train(config("trained", "train: {steps: 60}\n"));
  const std::string file = model_path(dir_ / "trained").string();
  const double fresh = sweep_rates(config("run"), at::kCPU, 10).points[0].loss;
  const double trained =
      sweep_rates(config("run", "train: {init_weights: " + file + "}\n"), at::kCPU, 10)
          .points[0]
          .loss;
  EXPECT_LT(trained, 0.8 * fresh);
}

TEST_F(Tune, FindLrWritesItsCurveAndTouchesNoCheckpoint) {
  ASSERT_EQ(tool({"--stop-after", "1"}), 0) << error_;
  const std::string before = read_file(checkpoint_path(dir_ / "run"));
  const std::string log = read_file(dir_ / "run/log.jsonl");
  ASSERT_EQ(tool({"--find-lr=30", "--json", (dir_ / "out.json").string()}), 0) << error_;
  EXPECT_NE(out_.find("suggestion: --set train.learning_rate="), std::string::npos) << out_;
  EXPECT_EQ(read_file(checkpoint_path(dir_ / "run")), before);
  EXPECT_EQ(read_file(dir_ / "run/log.jsonl"), log);
  const auto lines = test::lines_of(dir_ / "run/find_lr.jsonl");
  const auto json = nlohmann::json::parse(read_file(dir_ / "out.json"));
  EXPECT_EQ(lines.size(), json.at("steps").get<size_t>());
  for (const char* key : {"step", "lr", "loss", "smoothed_loss"})
    EXPECT_TRUE(nlohmann::json::parse(lines[3]).at(key).is_number()) << key;
  EXPECT_EQ(json.at("suggestion"),
            std::min(json.at("steepest").get<double>(), json.at("lowest").get<double>() / 10));
}

TEST_F(Tune, LearnsOneSceneByHeart) {
  TrainConfig run = config("run",
                           "data: {queries_per_scene: 48}\nloss: {epsilon: 0.1}\n"
                           "train: {steps: 900, learning_rate: 3.0e-3, warmup_steps: 20}\n");
  const OverfitResult result = overfit_one_scene(run, at::kCPU);
  EXPECT_TRUE(result.reached()) << result.psnr << " dB after " << result.steps << " steps";
  EXPECT_EQ(result.scene, "room0");
  EXPECT_EQ(result.queries, 48);
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

TEST_F(Tune, OverfittingThatFailsIsAFailedRun) {
  EXPECT_EQ(tool({"--overfit-one-scene", "--set", "train.steps=2", "--json",
                  (dir_ / "out.json").string()}),
            1);
  for (const char* part : {"--overfit-one-scene", "room0", "dB after 2 steps", "below 45 dB"})
    EXPECT_NE(error_.find(part), std::string::npos) << error_;
  EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
  EXPECT_EQ(nlohmann::json::parse(read_file(dir_ / "out.json")).at("reached"), false);
  EXPECT_EQ(tool({"--overfit-one-scene", "--find-lr"}), 2);
  EXPECT_EQ(tool({"--overfit-one-scene", "--resume"}), 2);
  EXPECT_EQ(tool({"--find-lr=3"}), 2);
}

}  // namespace
}  // namespace lte::train
