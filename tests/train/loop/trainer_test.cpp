#include "train/loop/trainer.h"

#include <cmath>
#include <fstream>

#include <ATen/Parallel.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "tests/train/run_fixture.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class TrainerTest : public test::RunFixture {};
using test::expect_same_tensors;
using test::log_values;

TEST_F(TrainerTest, OverfitsOneScene) {
  const test::TempDir one;
  test::write_dataset(one.path(), 1, 0);
  TrainConfig run =
      config("run",
             "augment: {rotate: none, mirror: false, permute_colors: false, gain: 1, tint: 1}\n"
             "model: {dropout: 0}\n"
             "data: {scene_points: 0, queries_per_scene: 0}\n"
             "train: {steps: 120, scenes_per_step: 1, learning_rate: 4.0e-3, log_every: 1}\n");
  run.data.root = one.path().string();
  train(run);
  const std::vector<Json> log = log_values(dir_ / "run");
  ASSERT_EQ(log.size(), 120u);
  const double first = log.front().at("loss").get<double>(),
               last = log.back().at("loss").get<double>();
  EXPECT_LT(last, 0.15 * first) << "of " << first;
}

TEST_F(TrainerTest, KeepsTheBestModelOfTheRun) {
  const TrainSummary summary = train(config("run", "train: {steps: 12, validate_every: 2}\n"));
  double best = 1e9;
  int64_t best_step = 0;
  for (const Json& line : log_values(dir_ / "run")) {
    if (!line.contains("val_loss") || line.at("val_loss").get<double>() >= best) continue;
    best = line.at("val_loss").get<double>();
    best_step = line.at("step").get<int64_t>();
  }
  EXPECT_EQ(summary.best_loss, best);
  EXPECT_EQ(SafetensorsFile(dir_ / "run/model_best.safetensors").metadata("step"),
            std::to_string(best_step));
}

TEST_F(TrainerTest, ResumedEqualsUninterruptedBitForBit) {
  train(config("straight"));
  EXPECT_EQ(train(config("pieces"), false, 3).step,
            3);  // in the middle of a line of the log, and of an epoch
  EXPECT_EQ(train(config("pieces"), true, 2).step, 5);
  EXPECT_EQ(train(config("pieces"), true).step, 8);
  for (const char* file :
       {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors"}) {
    expect_same_tensors(dir_ / "straight" / file, dir_ / "pieces" / file);
  }
  EXPECT_EQ(log_values(dir_ / "straight"), log_values(dir_ / "pieces"));
}

TEST_F(TrainerTest, ADataSetLargerThanTheCacheGivesTheSameBits) {
  train(config("large"));
  train(config("small", "data: {cache_mb: 0}\n"));
  expect_same_tensors(dir_ / "large/checkpoint.safetensors", dir_ / "small/checkpoint.safetensors");
}

TEST_F(TrainerTest, ScenesBesideEachOtherGiveTheBitsOfScenesOneByOne) {
  // Three scenes on two threads: a full round, and one with a thread to spare.
  const std::string three = "model: {dropout: 0}\ntrain: {scenes_per_step: 3}\n";
  train(config("one", three));
  at::set_num_threads(2);
  train(config("two", three));
  at::set_num_threads(1);
  expect_same_tensors(dir_ / "one/checkpoint.safetensors", dir_ / "two/checkpoint.safetensors");
}

TEST_F(TrainerTest, ACrashAfterTheCheckpointLosesNothing) {
  train(config("straight"));
  train(config("crashed"), false, 3);
  // As if steps 4 and 5 had been done and logged, and then the power had failed in a line and
  // before the model file.
  std::ofstream(dir_ / "crashed/log.jsonl", std::ios::app)
      << "{\"step\":4,\"loss\":9}\n{\"step\":5,\"va";
  fs::remove(dir_ / "crashed/model.safetensors");
  train(config("crashed"), true);
  expect_same_tensors(dir_ / "straight/model.safetensors", dir_ / "crashed/model.safetensors");
  EXPECT_EQ(log_values(dir_ / "straight"), log_values(dir_ / "crashed"));
}

TEST_F(TrainerTest, LogHasEveryLineItPromises) {
  train(config("run"));
  const std::vector<std::string> lines = test::lines_of(dir_ / "run/log.jsonl");
  std::vector<int64_t> train_steps, val_steps;
  for (const std::string& text : lines) {
    const Json line = Json::parse(text);
    const bool val = line.contains("val_loss");
    (val ? val_steps : train_steps).push_back(line.at("step").get<int64_t>());
    const std::vector<const char*> keys =
        val ? std::vector<const char*>{"val_loss", "val_loss_median", "val_mse",
                                       "val_psnr", "val_relmse",      "val_bias"}
            : std::vector<const char*>{"loss",    "lr",         "grad_norm", "queries_per_s",
                                       "seconds", "wait_share", "rss_mb"};
    for (const char* key : keys)
      EXPECT_TRUE(line.contains(key) && line.at(key).is_number()) << key << ": " << text;
  }
  for (const std::string& text : lines) {
    const Json line = Json::parse(text);
    if (!line.contains("wait_share")) continue;
    EXPECT_GE(line.at("wait_share").get<double>(), 0);
    EXPECT_LE(line.at("wait_share").get<double>(), 1);
  }
  EXPECT_EQ(train_steps, (std::vector<int64_t>{2, 4, 6, 8}));
  EXPECT_EQ(val_steps, (std::vector<int64_t>{4, 8}));
}

TEST_F(TrainerTest, NormsOfModulesMakeUpThatOfTheWholeGradientBeforeClipping) {
  // A limit that every step exceeds: after clipping the sum would be its square.
  train(config("run", "train: {clip_norm: 1.0e-3}\n"));
  const std::vector<Json> lines = log_values(dir_ / "run");
  int compared = 0;
  for (const Json& line : lines) {
    if (!line.contains("grad_norm")) continue;
    const double norm = line.at("grad_norm").get<double>();
    EXPECT_GT(norm, 2e-3);
    double sum = 0;
    for (const auto& [name, value] : line.items())
      if (name.starts_with("grad_norm_")) sum += std::pow(value.get<double>(), 2);
    EXPECT_NEAR(sum, norm * norm, 1e-9 * norm * norm);
    for (const char* module : {"nne", "encoder_stem", "encoder_down0", "decoder"})
      EXPECT_GT(line.at(std::string("grad_norm_") + module).get<double>(), 0) << module;
    ++compared;
  }
  EXPECT_EQ(compared, 4);
}

TEST_F(TrainerTest, ModelFileIsTheAveragedOneAndSaysWhereItCameFrom) {
  const TrainSummary summary = train(config("run"));
  nn::LightTransportModel model = nn::load_model(dir_ / "run/model.safetensors");
  EXPECT_EQ(model->config().scale, 8) << "the data set's";
  const TrainConfig run = config("run");
  RunData data = open_run_data(run);
  const ValidationResult again =
      validate(model, validation_examples(run, &data.val), SceneLossConfig(run), at::kCPU);
  EXPECT_NEAR(again.loss, summary.validation->loss, 1e-6 * again.loss);
  const SafetensorsFile file(dir_ / "run/model.safetensors");
  EXPECT_EQ(file.metadata("config"), "note: of the test\n");
  EXPECT_EQ(file.metadata("step"), "8");
  EXPECT_EQ(file.metadata("scene_points_pruned"), "false") << "as dataset.json says";
  EXPECT_EQ(file.metadata("suns"), "false") << "as dataset.json says";
}

TEST_F(TrainerTest, ErrorsOfEachKindOfSceneAreThoseOfItsScenesAlone) {
  train(config("run"));
  nn::LightTransportModel model = nn::load_model(dir_ / "run/model.safetensors");
  const TrainConfig run = config("run");
  RunData data = open_run_data(run);
  std::vector<Example> examples = validation_examples(run, &data.val);
  ASSERT_EQ(examples.size(), 2u);
  EXPECT_TRUE(validate(model, examples, SceneLossConfig(run), at::kCPU).kinds.empty())
      << "both are rooms";
  examples[0].scene = "home_00007";
  examples[1].scene = "box_00007";
  const ValidationResult both = validate(model, examples, SceneLossConfig(run), at::kCPU),
                         home = validate(model, {examples[0]}, SceneLossConfig(run), at::kCPU),
                         box = validate(model, {examples[1]}, SceneLossConfig(run), at::kCPU);
  ASSERT_EQ(both.kinds.size(), 2u);
  EXPECT_EQ(both.kinds[0].kind, "box");
  EXPECT_EQ(both.kinds[0].loss, box.loss);
  EXPECT_EQ(both.kinds[0].mse, box.mse);
  EXPECT_EQ(both.kinds[1].kind, "home");
  EXPECT_EQ(both.kinds[1].loss, home.loss);
  EXPECT_EQ(both.kinds[1].mse, home.mse);
  EXPECT_NEAR(both.loss, 0.5 * (box.loss + home.loss), 1e-9 * both.loss);
  EXPECT_EQ(both.fields().back().first, "val_mse_home");
}

TEST(SceneKind, IsTheNameWithoutItsNumber) {
  EXPECT_EQ(scene_kind("home_00012"), "home");
  EXPECT_EQ(scene_kind("living_room_2"), "living_room");
  EXPECT_EQ(scene_kind("room7"), "room");
  EXPECT_EQ(scene_kind("kitchen"), "kitchen");
  EXPECT_EQ(scene_kind("2026"), "2026");
}

TEST_F(TrainerTest, AFirstOutputNearTheMeanOfTheReference) {
  const TrainConfig run =
      config("run", "train: {steps: 1, learning_rate: 1.0e-9, min_learning_rate: 0}\n");
  const double bias = train(run).validation->bias;
  RunData data = open_run_data(run);
  const double mean = nn::load_model(dir_ / "run/model.safetensors")->config().output_mean;
  EXPECT_NEAR(mean, mean_target(run, &data.train), 1e-6 * mean);
  // The bias of the one answer `mean`, and by how much that of answers a tenth away differs.
  double constant = 0, tenth = 0;
  const std::vector<Example> examples = validation_examples(run, &data.val);
  for (const Example& example : examples) {
    const double share = mean / example.target.mean().item<double>();
    constant += (share - 1) / static_cast<double>(examples.size());
    tenth += 0.1 * share / static_cast<double>(examples.size());
  }
  EXPECT_NEAR(bias, constant, tenth);
  const double without = std::log(2.0);  // softplus(0)
  EXPECT_GT(std::abs(without / mean - 1), 0.3) << "else the test tells nothing";
}

TEST_F(TrainerTest, AnOverflowingLossStopsWithStepAndSceneAndKeepsTheCheckpoint) {
  const test::TempDir bad;
  TrainConfig run =
      config("run", "train: {scenes_per_step: 1, checkpoint_every: 1}\nmodel: {output_mean: 1}\n");
  run.data.root = bad.path().string();
  // The scene of the second step. Its values are valid float32, their sum over luminaires is not.
  const size_t second = EpochOrder(run.seed, 2).scene_at(1);
  test::write_dataset(bad.path(), 2, 0, [&](int i, data::SceneSample* sample) {
    if (static_cast<size_t>(i) == second)
      std::fill(sample->indirect.begin(), sample->indirect.end(), Rgb{3e38f, 3e38f, 3e38f});
  });
  test::expect_error([&] { train(run); }, {"step 2: scene room" + std::to_string(second),
                                           "the loss is not finite", "no update"});
  EXPECT_EQ(read_checkpoint_header(dir_ / "run/checkpoint.safetensors").progress.step, 1);
}

TEST_F(TrainerTest, AFirstStartThatFailsLeavesNothing) {
  const std::string none = (dir_ / "none.safetensors").string();
  test::expect_error([&] { train(config("run", "train: {init_weights: " + none + "}\n")); },
                     {"none.safetensors"});
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

/// Light on the scene points of a room, with errors.
void add_light(int, data::SceneSample* sample) {
  const auto rows = static_cast<size_t>(sample->light_groups * sample->scene_points());
  sample->scene_direct.assign(rows, Rgb{1, 1, 1});
  sample->scene_indirect.assign(rows, Rgb{1, 1, 1});
  sample->scene_direct_back.assign(rows, Rgb{0.25f, 0.5f, 1});
  sample->scene_indirect_back.assign(rows, Rgb{0, 0.5f, 0.25f});
  sample->scene_error.assign(rows, to_half(0.5f));
  sample->scene_error_back.assign(rows, to_half(1.0f));
}

TEST_F(TrainerTest, AModelThatReadsLightIsBoundToHowItWasEstimated) {
  const test::TempDir lit;
  test::write_dataset(lit.path(), 2, 0, add_light);
  const auto estimated = [&](int paths, int depth) {
    data::DatasetInfo info = data::read_dataset_info(lit.path());
    info.light_paths = paths;
    info.light_depth = depth;
    info.suns = true;
    data::write_dataset_info(lit.path(), info);
  };
  const auto on_it = [&](const char* name, const std::string& extra) {
    TrainConfig run = config(name, extra);
    run.data.root = lit.path().string();
    return run;
  };
  const std::string traced = "model: {light_input: traced}\n";
  estimated(16, 3);
  train(on_it("run", traced), false, 1);
  const SafetensorsFile model(dir_ / "run/model.safetensors");
  EXPECT_EQ(model.metadata("light_paths"), "16");
  EXPECT_EQ(model.metadata("light_depth"), "3");
  EXPECT_EQ(model.metadata("suns"), "true");
  train(on_it("plain", ""), false, 1);
  EXPECT_FALSE(
      SafetensorsFile(dir_ / "plain/model.safetensors").metadata().contains("light_depth"));
  estimated(16, 5);
  const std::vector<std::string> parts = {"16 paths of depth 3", "16 of depth 5"};
  test::expect_error([&] { train(on_it("run", traced), true); }, parts);
  for (const char* file : {"model.safetensors", "checkpoint.safetensors"}) {
    const std::string init = "train: {init_weights: " + (dir_ / "run" / file).string() + "}\n";
    test::expect_error([&] { train(on_it("next", traced + init)); }, parts);
  }
  EXPECT_EQ(train(on_it("plain", ""), true, 1).step, 2) << "it reads none";
  estimated(16, 3);
  EXPECT_EQ(train(on_it("run", traced), true, 1).step, 2);
}

TEST_F(TrainerTest, AModelThatReadsEstimatesTrainsAndWantsPathsEnough) {
  const test::TempDir lit;
  test::write_dataset(lit.path(), 2, 1, add_light);
  TrainConfig run = config("run", "model: {light_input: traced}\n");
  run.data.root = lit.path().string();
  EXPECT_EQ(train(run, false, 2).step, 2);
  const SafetensorsFile model(dir_ / "run/model.safetensors");
  EXPECT_THAT(model.metadata("model_config"), testing::HasSubstr("light_input: traced"));
  data::DatasetInfo info = data::read_dataset_info(lit.path());
  info.light_paths = 3;
  data::write_dataset_info(lit.path(), info);
  run = config("few", "model: {light_input: traced}\n");
  run.data.root = lit.path().string();
  test::expect_error([&] { train(run); }, {"model.light_input traced", "3 paths", "fewer than 4"});
}

TEST_F(TrainerTest, ASceneLargerThanTheScaleIsNamed) {
  const test::TempDir bad;
  test::write_dataset(bad.path(), 1, 0,
                      [](int, data::SceneSample* sample) { sample->scene_position[20].x = 30; });
  TrainConfig run = config("run");
  run.data.root = bad.path().string();
  test::expect_error([&] { train(run); }, {"room0.safetensors", "30 m wide", "scale of 8 m"});
}

TEST_F(TrainerTest, RefusesToOverwriteARun) {
  train(config("run"), false, 1);
  test::expect_error([&] { train(config("run")); },
                     {"checkpoint.safetensors", "--resume", "--out"});
}

TEST_F(TrainerTest, RefusesToResumeNothing) {
  test::expect_error([&] { train(config("run"), true); },
                     {"checkpoint.safetensors", "nothing to resume"});
}

TEST_F(TrainerTest, RefusesToResumeWithAnotherModelSeedOrScale) {
  train(config("run"), false, 1);
  test::expect_error([&] { train(config("run", "model: {channels: 64}\n"), true); },
                     {"checkpoint.safetensors", "model.channels (64, was 32)"});
  test::expect_error([&] { train(config("run", "model: {preset: lte}\n"), true); },
                     {"model.preset (lte, was paper)"});
  test::expect_error([&] { train(config("run", "seed: 6\n"), true); }, {"seed"});
  test::expect_error([&] { train(config("run", "model: {scale: 9}\n"), true); },
                     {"model.scale", "9", "8"});
}

TEST_F(TrainerTest, MoreStepsMayBeAddedAndAFinishedRunStaysAsItIs) {
  train(config("run"));
  const TrainSummary again = train(config("run"), true);
  EXPECT_EQ(again.step, 8);
  EXPECT_EQ(train(config("run", "train: {steps: 10}\n"), true).step, 10);
}

TEST_F(TrainerTest, EmptyOrMissingDataAreNamed) {
  TrainConfig run = config("run");
  run.data.root = "";
  test::expect_error([&] { train(run); }, {"data.root"});
  run.data.root = (dir_ / "none").string();
  test::expect_error([&] { train(run); }, {"none"});
  const test::TempDir only_val;
  test::write_dataset(only_val.path(), 0, 1);
  run.data.root = only_val.path().string();
  test::expect_error([&] { train(run); }, {"dataset.json", "train"});
}

}  // namespace
}  // namespace lte::train
