#include "train/command/dry_run.h"

#include <nlohmann/json.hpp>

#include "lte/nn/cost.h"
#include "tests/train/support.h"
#include "train/optim/optimizer.h"

namespace lte::train {
namespace {

TrainConfig shipped(const std::string& name) {
  return TrainConfig::read(Config::load(std::filesystem::path(LTE_SOURCE_DIR) / "configs" / name));
}

TEST(DryRun, ThePaperHasItsFortyTwoMillionParameters) {
  const auto report = dry_run(shipped("model/paper.yaml"));
  const auto& counts = report.at("parameters");
  EXPECT_NEAR(counts.at("total").get<double>(), 42e6, 0.03 * 42e6);
  EXPECT_EQ(counts.at("total"), counts.at("nne").get<int64_t>() +
                                    counts.at("encoder").get<int64_t>() +
                                    counts.at("decoder").get<int64_t>());
  int64_t sum = 0;
  for (const auto& [name, count] : report.at("modules").items()) sum += count.get<int64_t>();
  EXPECT_EQ(counts.at("total"), sum);
}

TEST(DryRun, ShapesFollowTheConfiguration) {
  const auto shapes = dry_run(test::tiny_config("data", "run")).at("shapes");
  EXPECT_EQ(shapes.at("scene_points").dump(), "[192,12]");
  EXPECT_EQ(shapes.at("embedding").dump(), "[48,32]");
  EXPECT_EQ(shapes.at("keys").dump(), "[2,48,32]");
  EXPECT_EQ(shapes.at("irradiance").dump(), "[96,3]");
}

TEST(DryRun, WeightsAndMomentsAreCountedExactly) {
  TrainConfig config = test::tiny_config("data", "run");
  const nn::LightTransportModel model(config.model);
  const auto bytes = 4.0 * static_cast<double>(nn::count_parameters(model).total);
  const MemoryEstimate with_average = estimate_memory(config, model);
  EXPECT_EQ(with_average.weights, bytes);
  EXPECT_EQ(with_average.gradients, bytes);
  EXPECT_EQ(with_average.moments, 2 * bytes);
  EXPECT_EQ(with_average.average, bytes);
  config.train.ema_decay = 0;
  EXPECT_EQ(estimate_memory(config, model).average, 0);
  const double before = with_average.activations;
  config.data.queries_per_scene *= 2;
  config.data.scene_points *= 2;
  EXPECT_NEAR(estimate_memory(config, model).activations, 2 * before, 1e-6 * before);
}

TEST(DryRun, MuonHasOneMomentOfTheMatricesThatItMoves) {
  TrainConfig config = test::tiny_config("data", "run");
  config.train.optimizer = OptimizerKind::Muon;
  const nn::LightTransportModel model(config.model);
  const Optimizer optimizer(config.train, model);
  double bytes = 0;
  for (const auto& [name, tensor] : optimizer.state()) {
    if (name.starts_with("exp_avg")) bytes += static_cast<double>(tensor.nbytes());
  }
  const MemoryEstimate memory = estimate_memory(config, model);
  EXPECT_EQ(memory.moments, bytes);
  EXPECT_LT(memory.moments, 1.5 * memory.weights);
}

TEST(DryRun, TableShowsTheSameNumbers) {
  nlohmann::ordered_json report;
  report["parameters"] = {{"total", 41932803}, {"nne", 992}};
  report["modules"] = {{"encoder.stem", 2048000}};
  report["shapes"] = {{"queries", {8192, 9}}};
  report["memory_mb"] = {{"weights", 159.96}};
  const std::string table = dry_run_table(report);
  for (const char* part : {"41,932,803", " 992\n", "2,048,000", "[8192,9]", "160.0"}) {
    EXPECT_NE(table.find(part), std::string::npos) << table;
  }
}

}  // namespace
}  // namespace lte::train
