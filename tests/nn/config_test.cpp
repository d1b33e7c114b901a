#include "lte/nn/config.h"

#include <tuple>

#include <gtest/gtest.h>

#include "tests/nn/support.h"

namespace lte::nn {
namespace {

ModelConfig parse(const std::string& yaml) {
  const Config config = Config::parse(yaml, "test.yaml");
  const ModelConfig model = ModelConfig::read(config);
  config.finish();
  return model;
}

TEST(ModelConfig, YamlRoundTripKeepsEveryField) {
  ModelConfig config = test::tiny_geometric_config();
  config.nne_neighbours = 7;
  config.grid_per_spacing = 1.0 / 3;
  config.dropout = 0.125;
  config.ffn_ratio = 3;
  config.light_input = LightInput::Traced;
  config.light_sides = LightSides::Apart;
  config.light_variance = true;
  config.target = Target::Total;
  config.scale = 12.345678901234567;
  config.output_mean = 1e-3;
  const std::string yaml = config.to_yaml();
  const ModelConfig back = parse(yaml);
  EXPECT_EQ(back.to_yaml(), yaml);
  EXPECT_EQ(back.scale, config.scale);
  EXPECT_EQ(back.grid_per_spacing, config.grid_per_spacing);
  EXPECT_EQ(back.encoder_depths, config.encoder_depths);
  EXPECT_EQ(back.target, Target::Total);
  EXPECT_NE(yaml, ModelConfig{}.to_yaml());
}

TEST(ModelConfig, DifferencesAreInTheOrderOfTheKeys) {
  ModelConfig a, b;
  EXPECT_TRUE(differences(a, b).empty());
  b.target = Target::Total;
  b.encoder_depths = {1, 1};
  const std::vector<ConfigDifference> found = differences(a, b);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].key, "encoder_depths");
  EXPECT_EQ(found[0].first, "[2, 2, 2, 6, 2]");
  EXPECT_EQ(found[0].second, "[1, 1]");
  EXPECT_EQ(found[1].key, "target");
  EXPECT_EQ(found[1].second, "total");
}

TEST(ModelConfig, LightIsAsManyColumnsAsItIsTold) {
  for (const auto& [yaml, point, query] : std::vector<std::tuple<std::string, int64_t, int64_t>>{
           {"{}", 12, 9},
           {"light_input: direct", 15, 9},
           {"light_input: traced", 18, 21},
           {"{light_input: direct, light_sides: apart}", 18, 9},
           {"{light_input: traced, light_sides: apart}", 24, 21},
           {"{light_input: traced, light_sides: apart, light_variance: true}", 26, 22},
           {"gloss: true", 14, 9},
           {"{light_input: traced, light_sides: apart, gloss: true}", 26, 21}}) {
    const ModelConfig config = parse(yaml);
    EXPECT_EQ(config.point_inputs(), point) << yaml;
    EXPECT_EQ(config.query_inputs(), query) << yaml;
  }
}

TEST(ModelConfig, ErrorsNameTheKey) {
  for (const auto& [yaml, key] : std::vector<std::pair<std::string, std::string>>{
           {"channels: 0", "channels"},
           {"nne_neighbours: 0", "nne_neighbours"},
           {"head_width: 0", "head_width"},
           {"patch_size: -1", "patch_size"},
           {"query_neighbours: 0", "query_neighbours"},
           {"query_layers: 0", "query_layers"},
           {"gamma_hidden: 0", "gamma_hidden"},
           {"query_attention: mean", "query_attention"},
           {"ffn_ratio: 0", "ffn_ratio"},
           {"radiance_lobes: -1", "radiance_lobes"},
           {"radiance_head: disc", "radiance_head"},
           {"{radiance_lobes: 4, radiance_base: points}",
            "radiance_base points: model.light_input"},
           {"{radiance_lobes: 4, radiance_base: points, light_input: traced, radiance_head: map}",
            "radiance_head must be directions or early, got map"},
           {"encoder_depths: []", "encoder_depths"},
           {"encoder_depths: [1, -1, 1, 1, 1]", "encoder_depths"},
           {"encoder_widths: [1, 2]", "encoder_widths"},
           {"decoder_depths: [1]", "decoder_depths"},
           {"decoder_widths: [1, 1, 0, 1]", "decoder_widths"},
           {"channels: 100", "head_width"},
           {"stem: conv7", "stem: expected conv5 | conv3 | linear, got \"conv7\"; did you mean"},
           {"light_input: trace", "did you mean \"traced\"?"},
           {"light_sides: apart", "light_sides apart: model.light_input must not be emission"},
           {"{light_input: traced, light_sides: both}", "light_sides: expected sum | apart"},
           {"{light_input: traced, light_variance: true}", "light_sides apart, got traced and sum"},
           {"{light_input: direct, light_sides: apart, light_variance: true}", "got direct"},
           {"{light_input: traced, light_variance: maybe}", "light_variance"},
           {"target: direct", "target"},
           {"grid_per_spacing: 0", "grid_per_spacing"},
           {"attention_positions: cells", "attention_positions"},
           {"{attention_positions: rotary, head_width: 4}", "head_width must be even"},
           {"{attention_positions: rotary, channels: 16, head_width: 32}", "does not divide"},
           {"centering: batch", "centering"},
           {"pair_geometry: distance", "pair_geometry"},
           {"dropout: 1", "dropout"},
           {"scale: -1", "scale"},
           {"output_mean: 0", "output_mean"},
           {"chanels: 64", "channels"}}) {
    test::expect_error([&, text = yaml] { parse(text); }, {key});
  }
}

}  // namespace
}  // namespace lte::nn
