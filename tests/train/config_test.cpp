#include "train/config.h"

#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "tests/train/support.h"

namespace lte::train {
namespace {

TrainConfig parsed(const std::string& yaml) {
  return TrainConfig::read(Config::parse(yaml, "cfg.yaml"));
}

TEST(TrainConfig, BaseYamlHoldsTheDefaultsOfTheCode) {
  const std::filesystem::path base = std::filesystem::path(LTE_SOURCE_DIR) / "configs/base.yaml";
  const TrainConfig file = TrainConfig::read(Config::load(base)), code;
  EXPECT_EQ(file.model.to_yaml(), code.model.to_yaml());
  EXPECT_EQ(file.data.scene_points, code.data.scene_points);
  EXPECT_EQ(file.data.queries_per_scene, code.data.queries_per_scene);
  EXPECT_EQ(file.data.cache_mb, code.data.cache_mb);
  EXPECT_EQ(file.data.on_bad_scene, code.data.on_bad_scene);
  EXPECT_EQ(file.data.solved_light, code.data.solved_light);
  EXPECT_EQ(file.augment.rotate, code.augment.rotate);
  EXPECT_EQ(file.augment.permute_colors, code.augment.permute_colors);
  EXPECT_EQ(file.train.keep_checkpoints, code.train.keep_checkpoints);
  EXPECT_EQ(file.train.init_weights, code.train.init_weights);
  EXPECT_EQ(file.train.init_except, code.train.init_except);
  EXPECT_EQ(file.augment.gain, code.augment.gain);
  EXPECT_EQ(file.augment.tint, code.augment.tint);
  EXPECT_EQ(file.train.steps, code.train.steps);
  EXPECT_EQ(file.train.scenes_per_step, code.train.scenes_per_step);
  EXPECT_EQ(file.train.learning_rate, code.train.learning_rate);
  EXPECT_EQ(file.train.min_learning_rate, code.train.min_learning_rate);
  EXPECT_EQ(file.train.warmup_steps, code.train.warmup_steps);
  EXPECT_EQ(file.train.weight_decay, code.train.weight_decay);
  EXPECT_EQ(file.train.clip_norm, code.train.clip_norm);
  EXPECT_EQ(file.train.ema_decay, code.train.ema_decay);
  EXPECT_EQ(file.train.autocast, code.train.autocast);
  EXPECT_EQ(file.train.validation_scenes, code.train.validation_scenes);
  EXPECT_EQ(file.loss.epsilon, code.loss.epsilon);
  EXPECT_EQ(file.augment.point_dropout, code.augment.point_dropout);
  EXPECT_FALSE(file.has_scale) << "the data set decides";
}

TEST(TrainConfig, EveryShippedConfigurationIsValid) {
  int files = 0;
  for (const char* folder : {"configs/model", "configs/train"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(LTE_SOURCE_DIR) / folder)) {
      EXPECT_NO_THROW(TrainConfig::read(Config::load(entry.path()))) << entry.path();
      ++files;
    }
  }
  EXPECT_GE(files, 4);
}

/// Keys of configs/base.yaml with their values as written there. A key that is there as a comment
/// alone, because the data decide it, has none.
std::map<std::string, std::string> keys_of_base() {
  const std::regex pattern(R"(^(  )?(# )?(\w+):\s*(\[[^\]]*\]|"[^"]*"|[^\s#]+)?.*$)");
  std::map<std::string, std::string> keys;
  std::string section;
  std::smatch match;
  const auto base = std::filesystem::path(LTE_SOURCE_DIR) / "configs/base.yaml";
  for (const std::string& line : test::lines_of(base)) {
    if (line.starts_with('#') || !std::regex_match(line, match, pattern)) continue;
    const bool inside = match[1].matched, comment = match[2].matched;
    if (!inside) section = match[4].matched ? "" : match[3].str() + ".";
    if (inside || match[4].matched) keys[section + match[3].str()] = comment ? "" : match[4].str();
  }
  return keys;
}

/// Keys of docs/training-keys.md, the first column of its tables, with the second column.
std::map<std::string, std::string> keys_of_page() {
  const std::regex pattern(R"(^\| `([\w.]+)` \| ([^|]+) \| [^|]+ \|$)");
  std::map<std::string, std::string> keys;
  std::smatch match;
  const auto page = std::filesystem::path(LTE_SOURCE_DIR) / "docs/training-keys.md";
  for (const std::string& line : test::lines_of(page)) {
    if (!line.starts_with("| `")) continue;
    EXPECT_TRUE(std::regex_match(line, match, pattern)) << line;
    EXPECT_TRUE(keys.emplace(match[1], match[2]).second) << match[1] << " is there twice";
  }
  return keys;
}

TEST(TrainConfig, ThePageOfKeysIsThatOfTheBaseYaml) {
  const auto base = keys_of_base(), page = keys_of_page();
  EXPECT_GT(base.size(), 50u);
  EXPECT_EQ(base.at("train.learning_rate"), "2.0e-4");
  for (const auto& [key, value] : base) {
    const auto found = page.find(key);
    ASSERT_NE(found, page.end()) << key << " is not in docs/training-keys.md";
    if (!value.empty()) {
      EXPECT_EQ(found->second, "`" + value + "`") << key;
    }
  }
  for (const auto& [key, value] : page)
    EXPECT_TRUE(base.contains(key)) << key << " is not in configs/base.yaml";
}

/// The keys of a configuration's YAML with their values.
std::map<std::string, std::string> keys_of(const nn::ModelConfig& model) {
  std::map<std::string, std::string> keys;
  std::istringstream yaml(model.to_yaml());
  for (std::string line; std::getline(yaml, line);)
    keys["model." + line.substr(0, line.find(':'))] = line.substr(line.find(':') + 2);
  return keys;
}

TEST(TrainConfig, ThePageHasTheDefaultsOfBothPresets) {
  const auto page = keys_of_page(), paper = keys_of(nn::ModelConfig::of(nn::Preset::Paper)),
             lte = keys_of(nn::ModelConfig::of(nn::Preset::Lte));
  for (const auto& [key, value] : paper) {
    if (key == "model.preset" || key == "model.scale" || key == "model.output_mean") continue;
    const std::string& other = lte.at(key);
    EXPECT_EQ(page.at(key),
              value == other ? concat('`', value, '`') : concat('`', value, "`; lte `", other, '`'))
        << key;
  }
}

TEST(TrainConfig, UnknownKeysNameTheNearest) {
  test::expect_error([] { parsed("train: {learing_rate: 1}\n"); },
                     {"cfg.yaml:1", "train.learing_rate", "train.learning_rate"});
  test::expect_error([] { parsed("model: {chanels: 1}\n"); }, {"model.chanels", "model.channels"});
  test::expect_error([] { parsed("traim: {steps: 1}\n"); }, {"traim", "train"});
  test::expect_error([] { parsed("model: {prest: lte}\n"); }, {"model.prest", "model.preset"});
}

TEST(TrainConfig, ValuesOutOfRangeNameTheKey) {
  for (const char* bad : {"train: {steps: 0}",
                          "train: {scenes_per_step: 0}",
                          "train: {learning_rate: 0}",
                          "train: {clip_norm: -1}",
                          "train: {min_learning_rate: 1}",
                          "train: {ema_decay: 1}",
                          "train: {autocast: fp16}",
                          "train: {weight_decay: -1}",
                          "train: {log_every: 0}",
                          "train: {checkpoint_every: 0}",
                          "train: {validate_every: 0}",
                          "train: {keep_checkpoints: 0}",
                          "train: {init_except: [x]}",
                          "train: {validation_scenes: -1}",
                          "train: {warmup_steps: -1}",
                          "data: {scene_points: -1}",
                          "data: {queries_per_scene: -1}",
                          "data: {cache_mb: -1}",
                          "data: {on_bad_scene: ignore}",
                          "augment: {rotate: sideways}",
                          "augment: {gain: 0.5}",
                          "augment: {tint: 1e9}",
                          "augment: {point_dropout: 0.5}",
                          "loss: {epsilon: 0}"}) {
    const std::string text = bad;
    const size_t brace = text.find('{');
    const std::string key = text.substr(0, text.find(':')) + "." +
                            text.substr(brace + 1, text.find(':', brace) - brace - 1);
    test::expect_error([&] { parsed(text + "\n"); }, {key});
  }
}

TEST(TrainConfig, AutocastIsOffUnlessBf16IsAskedFor) {
  EXPECT_EQ(parsed("{}\n").train.autocast, nn::Precision::Fp32);
  EXPECT_EQ(parsed("train: {autocast: none}\n").train.autocast, nn::Precision::Fp32);
  EXPECT_EQ(parsed("train: {autocast: bf16}\n").train.autocast, nn::Precision::Bf16);
  test::expect_error([] { parsed("train: {autocast: true}\n"); },
                     {"train.autocast: expected none | bf16, got \"true\""});
}

TEST(ModelDifferences, NameKeysButNotWhatTheDataDecide) {
  nn::ModelConfig a, b;
  EXPECT_TRUE(model_differences(a, b).empty());
  b.scale = 3;
  b.output_mean = 0.25;
  EXPECT_TRUE(model_differences(a, b).empty());
  b.channels = 64;
  b.encoder_depths = {1, 1};
  EXPECT_EQ(model_differences(a, b),
            (std::vector<std::string>{"channels (128, was 64)",
                                      "encoder_depths ([2, 2, 2, 6, 2], was [1, 1])"}));
}

}  // namespace
}  // namespace lte::train
