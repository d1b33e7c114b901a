// The mean of models' weights.
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "tests/support/message_of.h"
#include "tests/support/temp_dir.h"
#include "train/command/average_command.h"

namespace lte::train {
namespace {

nn::ModelConfig small_config() {
  nn::ModelConfig config;
  config.channels = 16;
  config.head_width = 16;
  config.encoder_depths = {1, 1};
  config.encoder_widths = {1, 1};
  config.decoder_depths = {1};
  config.decoder_widths = {1};
  return config;
}

nn::ModelConfig with_patches(int64_t size) {
  nn::ModelConfig config = small_config();
  config.patch_size = size;
  return config;
}

class Average : public ::testing::Test {
 protected:
  /// A model file with weights of its own.
  std::filesystem::path saved(const std::string& name, const nn::ModelConfig& config,
                              const std::string& step) const {
    const nn::LightTransportModel model(config);
    nn::save_model(folder_ / name, model, {{"step", step}, {"scene_points", "512"}});
    return folder_ / name;
  }
  std::filesystem::path out() const { return folder_ / "mean.safetensors"; }

  const test::TempDir folder_;
};

TEST_F(Average, IsTheMeanWithTheMetadataOfTheFirst) {
  const auto a = saved("a.safetensors", small_config(), "10"),
             b = saved("b.safetensors", with_patches(2'048), "20"),
             c = saved("c.safetensors", small_config(), "30");
  average_models({.models = {a, b, c}, .out = out(), .log_file = ""});
  const SafetensorsFile file(out());
  EXPECT_EQ(file.metadata("step"), "10");
  EXPECT_EQ(file.metadata("scene_points"), "512");
  EXPECT_EQ(file.metadata("averaged"), "3");
  EXPECT_EQ(nn::load_model(out())->config().to_yaml(), with_patches(2'048).to_yaml());
  const nn::LightTransportModel mean = nn::load_model(out()), first = nn::load_model(a),
                                second = nn::load_model(b), third = nn::load_model(c);
  for (const auto& item : mean->named_parameters()) {
    const auto of = [&](const nn::LightTransportModel& model) {
      return model->named_parameters()[item.key()].to(at::kDouble);
    };
    const at::Tensor expected = (of(first) + of(second) + of(third)) / 3;
    EXPECT_LT((item.value() - expected).abs().max().item<double>(), 1e-6) << item.key();
  }
}

TEST_F(Average, RefusesOtherShapesAndItsOwnInputs) {
  nn::ModelConfig wide = small_config();
  wide.channels = 32;
  const auto a = saved("a.safetensors", small_config(), "1"), b = saved("b.safetensors", wide, "1");
  const std::string shape = test::message_of([&] {
    average_models({.models = {a, b}, .out = out(), .log_file = ""});
  });
  EXPECT_NE(shape.find("b.safetensors: its width is D = 32"), std::string::npos) << shape;
  EXPECT_FALSE(std::filesystem::exists(out()));
  const std::string same = test::message_of([&] {
    average_models({.models = {a, a}, .out = a, .log_file = ""});
  });
  EXPECT_NE(same.find("--out"), std::string::npos) << same;
}

}  // namespace
}  // namespace lte::train
