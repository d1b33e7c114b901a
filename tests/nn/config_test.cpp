#include "lte/nn/config.h"

#include <tuple>

#include <gtest/gtest.h>

#include "lte/nn/constants.h"
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
  config.dropout = 0.125;
  config.light_input = LightInput::Traced;
  config.radiance_lobes = 3;
  config.scale = 12.345678901234567;
  config.output_mean = 1e-3;
  const std::string yaml = config.to_yaml();
  const ModelConfig back = parse(yaml);
  EXPECT_EQ(back.to_yaml(), yaml);
  EXPECT_EQ(back.preset, Preset::Lte);
  EXPECT_EQ(back.scale, config.scale);
  EXPECT_EQ(back.encoder_depths, config.encoder_depths);
  EXPECT_EQ(back.light_input, LightInput::Traced);
  EXPECT_NE(yaml, ModelConfig{}.to_yaml());
}

/// Table 1 of the paper's supplement, and its section 3.
TEST(ModelConfig, ThePresetPaperIsThePapersTable) {
  const ModelConfig paper = parse("preset: paper");
  EXPECT_EQ(paper.channels, 128);
  EXPECT_EQ(paper.nne_neighbours, 32);
  EXPECT_EQ(paper.encoder_depths, (std::vector<int64_t>{2, 2, 2, 6, 2}));
  std::vector<int64_t> channels;
  for (const int64_t width : paper.encoder_widths) channels.push_back(width * paper.channels);
  EXPECT_EQ(channels, (std::vector<int64_t>{128, 128, 128, 256, 256}));
  EXPECT_EQ(paper.patch_size, 1024);
  EXPECT_EQ(paper.channels / paper.head_width, 4);
  EXPECT_EQ(paper.query_layers, 6);
  EXPECT_EQ(paper.query_neighbours, 32);
  EXPECT_EQ(kFfnRatio * paper.channels, 512);
  EXPECT_EQ(paper.dropout, 0.1);
  // Its points carry emission alone, γ reads the offset, and PTv3's attention sees no positions.
  EXPECT_EQ(paper.point_inputs(), 12);
  EXPECT_EQ(paper.query_inputs(), 9);
  EXPECT_EQ(paper.pair_inputs(), 3);
  EXPECT_EQ(paper.stem_kernel(), 5);
  EXPECT_FALSE(paper.rotates_attention());
  EXPECT_FALSE(paper.centers_norms());
  EXPECT_FALSE(paper.predicts_radiance());
  EXPECT_EQ(paper.to_yaml(), ModelConfig{}.to_yaml());
  EXPECT_EQ(paper.to_yaml(), parse("{}").to_yaml()) << "it is the default";
}

TEST(ModelConfig, ThePresetIsTheDefaultOfEveryOtherKey) {
  const ModelConfig lte = parse("preset: lte"), wide = parse("{channels: 96, preset: lte}");
  EXPECT_EQ(lte.to_yaml(), ModelConfig::of(Preset::Lte).to_yaml());
  EXPECT_EQ(lte.channels, 48);
  EXPECT_EQ(lte.encoder_depths, (std::vector<int64_t>{2, 2, 6}));
  EXPECT_EQ(lte.light_input, LightInput::Radiosity);
  EXPECT_EQ(wide.channels, 96);
  EXPECT_EQ(wide.query_layers, lte.query_layers);
  EXPECT_EQ(differences(wide, lte).size(), 1u);
}

TEST(ModelConfig, DifferencesAreInTheOrderOfTheKeys) {
  ModelConfig a, b;
  EXPECT_TRUE(differences(a, b).empty());
  b.light_input = LightInput::Traced;
  b.encoder_depths = {1, 1};
  const std::vector<ConfigDifference> found = differences(a, b);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].key, "encoder_depths");
  EXPECT_EQ(found[0].first, "[2, 2, 2, 6, 2]");
  EXPECT_EQ(found[0].second, "[1, 1]");
  EXPECT_EQ(found[1].key, "light_input");
  EXPECT_EQ(found[1].second, "traced");
}

TEST(ModelConfig, LightErrorsAndGlossAreColumns) {
  for (const auto& [yaml, point, query] : std::vector<std::tuple<std::string, int64_t, int64_t>>{
           {"{}", 12, 9},
           {"light_input: traced", 26, 22},
           {"light_input: radiosity", 24, 21},
           {"preset: lte", 24, 21},
           {"{preset: lte, radiance_lobes: 8}", 26, 21}}) {
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
           {"radiance_lobes: -1", "radiance_lobes"},
           {"radiance_lobes: 4", "light_input must be traced or radiosity, got emission"},
           {"encoder_depths: []", "encoder_depths"},
           {"encoder_depths: [1, -1, 1, 1, 1]", "encoder_depths"},
           {"encoder_widths: [1, 2]", "encoder_widths"},
           {"decoder_depths: [1]", "decoder_depths"},
           {"decoder_widths: [1, 1, 0, 1]", "decoder_widths"},
           {"channels: 100", "head_width"},
           {"preset: ltee", "preset: expected paper | lte, got \"ltee\"; did you mean"},
           {"light_input: trace", "did you mean \"traced\"?"},
           {"{preset: lte, head_width: 4}", "head_width must be even"},
           {"{preset: lte, channels: 16, head_width: 32}", "does not divide"},
           {"dropout: 1", "dropout"},
           {"scale: -1", "scale"},
           {"output_mean: 0", "output_mean"},
           {"chanels: 64", "channels"}}) {
    test::expect_error([&, text = yaml] { parse(text); }, {key});
  }
}

}  // namespace
}  // namespace lte::nn
