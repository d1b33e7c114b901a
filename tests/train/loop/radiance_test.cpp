// Training of a radiance decoder on the weights of an irradiance model.
#include <gtest/gtest.h>

#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "tests/train/run_fixture.h"
#include "train/checkpoint/first_model.h"
#include "train/data/batch.h"

namespace lte::train {
namespace {

const std::string kModel = "model: {light_input: radiosity, radiance_lobes: 12, dropout: 0}\n";

std::vector<float> numbers(const SafetensorsFile& file, const std::string& tensor) {
  const auto values = file.values<float>(tensor, file.at(tensor).shape);
  return {values.begin(), values.end()};
}

/// Rooms with incident radiance, and an irradiance model that knows of neither it nor gloss.
class RadianceTraining : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new test::TempDir;
    test::write_dataset(data_->path() / "set", 3, 1,
                        [](int, data::SceneSample* sample) { test::add_incident(sample); });
    Trainer(test::tiny_config(data_->path() / "set", data_->path() / "first",
                              "model: {light_input: radiosity, dropout: 0}\ntrain: {steps: 4}\n"),
            "note: first\n", at::kCPU, false)
        .run();
  }
  static void TearDownTestSuite() { delete data_; }

  static std::string source() { return model_path(data_->path() / "first").string(); }
  TrainConfig config(const std::string& train, const std::string& more = "") const {
    return test::tiny_config(data_->path() / "set", dir_ / "run",
                             kModel + "train: {init_weights: " + source() +
                                 ", init_except: [radiance.], " + train + "}\n" + more);
  }
  static TrainSummary run(const TrainConfig& config, bool resume = false, int64_t stop = 0) {
    return Trainer(config, "note: of the test\n", at::kCPU, resume).run(stop);
  }

  test::TempDir dir_;
  static test::TempDir* data_;
};
test::TempDir* RadianceTraining::data_ = nullptr;

TEST_F(RadianceTraining, AWidenedModelAnswersIrradianceAsTheOneItStartsFrom) {
  TrainConfig start = config("steps: 1");
  RunData data = open_run_data(start);
  nn::LightTransportModel model = first_model(&start, &data);
  nn::LightTransportModel before = nn::load_model(source());
  model->eval();
  const torch::NoGradGuard no_grad;
  const Example example = validation_examples(start, &data.val).at(0);
  ASSERT_TRUE(example.points.gloss.defined());
  const at::Tensor a = model->decode(model->encode(example.points), example.queries),
                   b = before->decode(before->encode(example.points), example.queries);
  EXPECT_LT(((a - b).abs().max() / b.max()).item<double>(), 1e-5);
}

TEST_F(RadianceTraining, BeginsByGatheringLightAsTheIrradianceDecoderDoes) {
  TrainConfig start = config("steps: 1");
  RunData data = open_run_data(start);
  const nn::LightTransportModel model = first_model(&start, &data);
  const auto parameters = model->named_parameters();
  int copied = 0;
  for (const auto& item : parameters) {
    const std::string radiance = "radiance.query.";
    if (!item.key().starts_with(radiance)) continue;
    const at::Tensor irradiance = parameters["decoder." + item.key().substr(radiance.size())];
    if (item.key().starts_with(radiance + "head.")) {
      EXPECT_FALSE(item.value().sizes() == irradiance.sizes() &&
                   torch::equal(item.value(), irradiance))
          << item.key();
      continue;
    }
    ++copied;
    EXPECT_TRUE(torch::equal(item.value(), irradiance)) << item.key();
  }
  EXPECT_GT(copied, 20);
}

TEST_F(RadianceTraining, LowersTheLossOfRoomsItDoesNotTrainOn) {
  const TrainConfig few = config(
      "steps: 120, validate_every: 120, checkpoint_every: 120, "
      "learning_rate: 5.0e-3, init_rate: 0.1");
  TrainConfig start = few;
  RunData data = open_run_data(start);
  nn::LightTransportModel model = first_model(&start, &data);
  const ValidationResult before =
      validate(model, validation_examples(few, &data.val), SceneLossConfig(few), at::kCPU);
  const TrainSummary summary = run(few);
  ASSERT_TRUE(before.radiance && summary.validation && summary.validation->radiance);
  EXPECT_LT(summary.validation->radiance->loss, 0.5 * before.radiance->loss);
  EXPECT_GT(before.loss, before.radiance->loss) << "irradiance counts too";
}

TEST_F(RadianceTraining, WithARateOfZeroGivenParametersAreFrozen) {
  run(config("steps: 6, init_rate: 0", "loss: {irradiance_weight: 0}\n"));
  const SafetensorsFile before(source()), after(model_path(dir_ / "run"));
  int moved = 0;
  for (const auto& [name, tensor] : after.tensors()) {
    if (name.starts_with("radiance.")) {
      ++moved;
      continue;
    }
    if (name == "nne.point.hidden.weight") continue;  // wider by the columns of gloss
    EXPECT_EQ(numbers(after, name), numbers(before, name)) << name;
  }
  EXPECT_GT(moved, 20);
  const SafetensorsFile start(start_path(dir_ / "run"));
  for (const char* name : {"radiance.lobes.weight", "radiance.query.layer0.key.weight",
                           "radiance.query.point.hidden.weight", "radiance.color.bias"}) {
    EXPECT_NE(numbers(after, name), numbers(start, name)) << name;
  }
}

TEST_F(RadianceTraining, AResumedRunIsTheUninterruptedOne) {
  const std::string train = "steps: 6, checkpoint_every: 3, init_rate: 0.1";
  run(config(train));
  const std::filesystem::path whole = dir_ / "whole";
  std::filesystem::rename(dir_ / "run", whole);
  run(config(train), false, 3);
  run(config(train), true);
  test::expect_same_tensors(model_path(whole), model_path(dir_ / "run"));
}

TEST_F(RadianceTraining, KeysThatMeanNothingAreRefused) {
  test::expect_error([&] { config("init_rate: 2"); }, {"train.init_rate", "0", "1"});
  test::expect_error([&] { test::tiny_config("d", "r", "train: {init_rate: 0.1}\n"); },
                     {"train.init_rate", "init_weights"});
  test::expect_error([&] { test::tiny_config("d", "r", "loss: {irradiance_weight: 0}\n"); },
                     {"loss.irradiance_weight", "radiance"});
}

}  // namespace
}  // namespace lte::train
