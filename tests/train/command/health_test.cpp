// Whether every part of a network learns, and whether the figures that say so are right.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "lte/nn/files/model_file.h"
#include "tests/train/run_fixture.h"
#include "train/checkpoint/checkpoint.h"
#include "train/command/health_command.h"
#include "train/optim/weight_movement.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

/// Three stages with points enough to collapse, in the form of lte.
constexpr const char* kNetwork =
    "model: {encoder_depths: [1, 1, 1], encoder_widths: [1, 1, 2], decoder_depths: [1, 1], "
    "decoder_widths: [1, 1], dropout: 0, preset: lte, light_input: emission}\n";

class Health : public test::RunFixture {
 protected:
  /// Trains a run of `steps` steps, whose files say their whole configuration.
  fs::path trained(const std::string& run, int steps) const {
    const std::string extra =
        concat(kNetwork, "train: {steps: ", steps, ", validate_every: ", steps,
               ", checkpoint_every: 1000, log_every: 50, adam_epsilon: 1.0e-15}\n");
    const TrainConfig settings = config(run, extra);
    const fs::path base = dir_ / (run + "_base.yaml"), file = dir_ / (run + ".yaml");
    std::ofstream(base) << test::tiny_yaml(data_->path(), dir_ / run);
    std::ofstream(file) << "parent: " << base.filename().string() << "\n" << extra;
    Trainer(settings, Config::load(file).to_yaml(), at::kCPU, false).run();
    return dir_ / run;
  }

  HealthReport measured(const fs::path& model) const {
    return measure_health({.model = model.string(), .data = data_->path().string(), .scenes = 2});
  }
};

TEST_F(Health, AShortTrainingMovesEveryModuleAndCollapsesNoStage) {
  const fs::path run = trained("healthy", 300);
  const HealthReport report = measured(model_path(run));
  EXPECT_TRUE(report.faults().empty()) << health_table(report);
  ASSERT_EQ(report.stages.size(), 6u);  // stem, three down, two up
  for (const nn::StageHealth& stage : report.stages) {
    EXPECT_GT(stage.rms, 0) << stage.stage;
    EXPECT_LE(stage.varying, 1 + 1e-9) << stage.stage;
  }
  for (const ModuleHealth& module : report.modules) {
    EXPECT_GT(module.gradient_rms, 0) << module.module;
    if (module.module == "encoder_norm") continue;  // has no matrix that could move
    EXPECT_GT(module.moved, 0.01) << module.module;
  }
  // The log has the same figures of the weights that were trained.
  const nlohmann::json last = test::log_values(run).back();
  EXPECT_GT(last.at("health_varying_up0").get<double>(), 0);
  EXPECT_GT(last.at("health_moved_encoder_down2").get<double>(), 0.01);
}

TEST_F(Health, NamesAStageWithOneVectorForAllPointsAndAModuleThatStandsStill) {
  const fs::path run = trained("broken", 20);
  nn::LightTransportModel model = nn::load_model(model_path(run)),
                          start = nn::load_model(start_path(run));
  const auto before = start->named_parameters();
  for (auto& item : model->named_parameters()) {
    const torch::NoGradGuard no_grad;
    const std::string& name = item.key();
    // Without its weights a norm answers its bias, whatever the point; a large one drowns the rest.
    if (name == "encoder.stem_norm.weight") item.value().zero_();
    if (name == "encoder.stem_norm.bias") item.value().fill_(30);
    if (name.starts_with("encoder.down2.") || name.starts_with("encoder.pool2."))
      item.value().copy_(before[name]);
  }
  const fs::path broken = run / "broken.safetensors";
  nn::save_model(broken, model, {{"config", SafetensorsFile(model_path(run)).metadata("config")}});
  const std::vector<std::string> faults = measured(broken).faults();
  const auto named = [&](const std::string& part) {
    return std::any_of(faults.begin(), faults.end(),
                       [&](const std::string& fault) { return fault.starts_with(part); });
  };
  EXPECT_TRUE(named("stem: nearly one vector for all")) << testing::PrintToString(faults);
  EXPECT_TRUE(named("encoder_down2: stands still")) << testing::PrintToString(faults);
}

TEST_F(Health, WithoutTheFirstWeightsMovementIsUnknownAndNoFault) {
  const fs::path run = trained("orphan", 4);
  fs::remove(start_path(run));
  const HealthReport report = measured(model_path(run));
  for (const ModuleHealth& module : report.modules) EXPECT_TRUE(std::isnan(module.moved));
  for (const std::string& fault : report.faults())
    EXPECT_EQ(fault.find("stands still"), std::string::npos) << fault;
}

TEST_F(Health, RefusesWhatIsNoModelAndDataThatAreNotThere) {
  const fs::path run = trained("refused", 2);
  test::expect_error([&] { measured(dir_ / "none.safetensors"); }, {"none.safetensors"});
  test::expect_error(
      [&] {
        measure_health({.model = model_path(run).string(), .data = (dir_ / "nowhere").string()});
      },
      {"nowhere"});
}

TEST(WeightMovement, IsTheRelativeDistanceOfAModulesMatrices) {
  torch::manual_seed(1);
  nn::ModelConfig config;
  config.channels = 32;
  nn::LightTransportModel model(config);
  const WeightMovement movement(model);
  const torch::NoGradGuard no_grad;
  for (auto& item : model->named_parameters()) {
    if (item.key().starts_with("decoder.")) item.value().mul_(1.25);
    if (item.key().ends_with(".bias")) item.value().add_(7);  // vectors do not count
  }
  for (const auto& [module, moved] : movement.of(model))
    EXPECT_NEAR(moved, module == "decoder" ? 0.25 : 0, 1e-6) << module;
}

TEST(StageRecorder, TellsWhatPointsShareFromWhatTheyDoNot) {
  nn::StageRecorder recorder;
  const at::Tensor common = torch::full({40, 6}, 3.0), own = torch::randn({40, 6});
  recorder.stage("shared", common);
  recorder.stage("own", own - own.mean(0));
  recorder.block(0.5);
  recorder.block(0.75);
  recorder.stage("both",
                 4 * (own - own.mean(0)) / own.sub(own.mean(0)).square().mean().sqrt() + common);
  const auto& stages = recorder.stages();
  EXPECT_NEAR(stages[0].varying, 0, 1e-7);
  EXPECT_TRUE(stages[0].collapsed());
  EXPECT_NEAR(stages[0].rms, 3, 1e-6);
  EXPECT_TRUE(std::isnan(stages[0].entropy));
  EXPECT_NEAR(stages[1].varying, 1, 1e-6);
  EXPECT_FALSE(stages[1].collapsed());
  EXPECT_NEAR(stages[2].rms, 5, 1e-5);  // 3-4-5
  EXPECT_NEAR(stages[2].varying, 0.8, 1e-6);
  EXPECT_NEAR(stages[2].entropy, 0.625, 1e-12);
}

}  // namespace
}  // namespace lte::train
