// Runs in mixed precision: they resume bit for bit, learn as float32 does, and leave float32 files.
#include <cmath>

#include <ATen/Parallel.h>

#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "tests/train/run_fixture.h"

namespace lte::train {
namespace {

using test::expect_same_tensors;
using test::log_values;

class AutocastTest : public test::RunFixture {
 protected:
  TrainConfig bf16(const std::string& run, const std::string& extra = "") const {
    TrainConfig out = config(run, extra);
    out.train.autocast = nn::Precision::Bf16;
    return out;
  }
};

TEST_F(AutocastTest, ResumedEqualsUninterruptedBitForBit) {
  train(bf16("straight"));
  train(bf16("pieces"), false, 3);
  train(bf16("pieces"), true, 2);
  EXPECT_EQ(train(bf16("pieces"), true).step, 8);
  for (const char* file :
       {"checkpoint.safetensors", "model.safetensors", "model_best.safetensors"}) {
    expect_same_tensors(dir_ / "straight" / file, dir_ / "pieces" / file);
  }
  EXPECT_EQ(log_values(dir_ / "straight"), log_values(dir_ / "pieces"));
  train(config("plain"));
  EXPECT_NE(log_values(dir_ / "straight"), log_values(dir_ / "plain"));
}

TEST_F(AutocastTest, ScenesBesideEachOtherGiveTheBitsOfScenesOneByOne) {
  const std::string three = "model: {dropout: 0}\ntrain: {scenes_per_step: 3, steps: 4}\n";
  train(bf16("one", three));
  at::set_num_threads(2);
  train(bf16("two", three));
  at::set_num_threads(1);
  expect_same_tensors(dir_ / "one/checkpoint.safetensors", dir_ / "two/checkpoint.safetensors");
}

TEST_F(AutocastTest, WeightsMomentsAndAverageStayInFloat32AndSoDoesValidation) {
  const TrainConfig run = bf16("run");
  const TrainSummary summary = train(run);
  const SafetensorsFile file(dir_ / "run/checkpoint.safetensors");
  for (const auto& [name, tensor] : file.tensors()) EXPECT_NE(tensor.dtype, DType::BF16) << name;
  // The model file knows nothing of the run's casting.
  nn::LightTransportModel model = nn::load_model(dir_ / "run/model.safetensors");
  RunData data = open_run_data(run);
  const ValidationResult again =
      validate(model, validation_examples(run, &data.val), SceneLossConfig(run), at::kCPU);
  EXPECT_NEAR(again.loss, summary.validation->loss, 1e-6 * again.loss);
}

TEST_F(AutocastTest, LearnsAsFloat32Does) {
  const std::string many =
      "model: {dropout: 0}\ntrain: {steps: 60, validate_every: 60, log_every: 60}\n";
  const double single = train(config("fp32", many)).validation->loss;
  const double half = train(bf16("bf16", many)).validation->loss;
  const double first =
      train(bf16("first", "model: {dropout: 0}\ntrain: {steps: 1}\n")).validation->loss;
  EXPECT_LT(half, 0.85 * first);
  EXPECT_NEAR(half, single, 0.05 * single);
  EXPECT_NE(half, single);
}

}  // namespace
}  // namespace lte::train
