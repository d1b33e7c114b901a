#include "train/config.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/nn/constants.h"

namespace lte::train {
namespace {

/// Products of training steps are "none" or "bf16" rather than "fp32" or "bf16".
constexpr EnumNames<nn::Precision, 2> kAutocastNames = {
    {{nn::Precision::Fp32, "none"}, {nn::Precision::Bf16, "bf16"}}};

constexpr EnumNames<OptimizerKind, 2> kOptimizerNames = {
    {{OptimizerKind::AdamW, "adamw"}, {OptimizerKind::Muon, "muon"}}};

DataConfig read_data(const Config& config) {
  DataConfig data;
  config.read("root", &data.root);
  config.read("scene_points", &data.scene_points);
  config.read("queries_per_scene", &data.queries_per_scene);
  config.read("cache_mb", &data.cache_mb);
  config.read("on_bad_scene", &data.on_bad_scene);
  config.read("solved_light", &data.solved_light);
  config.read("radiance_points", &data.radiance_points);
  config.read("radiance_directions", &data.radiance_directions);
  LTE_CHECK(data.scene_points >= 0, "data.scene_points: expected 0 (all) or more, got ",
            data.scene_points);
  LTE_CHECK(data.queries_per_scene >= 0, "data.queries_per_scene: expected 0 (all) or more, got ",
            data.queries_per_scene);
  LTE_CHECK(data.radiance_points >= 0, "data.radiance_points: expected 0 (all) or more, got ",
            data.radiance_points);
  LTE_CHECK(data.radiance_directions >= 0,
            "data.radiance_directions: expected 0 (all) or more, got ", data.radiance_directions);
  LTE_CHECK(data.cache_mb >= 0, "data.cache_mb: expected 0 (keep nothing) or more, got ",
            data.cache_mb);
  return data;
}

AugmentConfig read_augment(const Config& config) {
  AugmentConfig augment;
  config.read("rotate", &augment.rotate);
  config.read("mirror", &augment.mirror);
  config.read("permute_colors", &augment.permute_colors);
  config.read("gain", &augment.gain);
  config.read("tint", &augment.tint);
  config.read("point_dropout", &augment.point_dropout);
  constexpr double kMax = 1e3;  // keeps products of both within float32 for any sane radiance
  LTE_CHECK(augment.gain >= 1 && augment.gain <= kMax, "augment.gain: expected 1 (off) to ", kMax,
            ", got ", augment.gain);
  LTE_CHECK(augment.tint >= 1 && augment.tint <= kMax, "augment.tint: expected 1 (off) to ", kMax,
            ", got ", augment.tint);
  LTE_CHECK(augment.point_dropout >= 1 && augment.point_dropout <= kMax,
            "augment.point_dropout: expected 1 (off) to ", kMax, ", got ", augment.point_dropout);
  return augment;
}

void check_at_least(const char* key, int64_t value, int64_t least) {
  LTE_CHECK(value >= least, key, ": expected ", least, " or more, got ", value);
}

void check_optim(const OptimConfig& train) {
  check_at_least("train.steps", train.steps, 1);
  check_at_least("train.scenes_per_step", train.scenes_per_step, 1);
  LTE_CHECK(train.scenes_per_pass >= 1 && train.scenes_per_pass <= nn::kMaxScenes,
            "train.scenes_per_pass: expected 1 to ", nn::kMaxScenes, ", got ",
            train.scenes_per_pass);
  check_at_least("train.warmup_steps", train.warmup_steps, 0);
  check_at_least("train.log_every", train.log_every, 1);
  check_at_least("train.checkpoint_every", train.checkpoint_every, 1);
  check_at_least("train.keep_checkpoints", train.keep_checkpoints, 1);
  check_at_least("train.validate_every", train.validate_every, 1);
  check_at_least("train.validation_scenes", train.validation_scenes, 0);
  check_at_least("train.validation_queries", train.validation_queries, 0);
  check_at_least("train.preview_every", train.preview_every, 0);
  check_at_least("train.timeout_s", train.timeout_s, 1);
  LTE_CHECK(train.learning_rate > 0, "train.learning_rate: expected a positive number, got ",
            train.learning_rate);
  LTE_CHECK(train.min_learning_rate >= 0 && train.min_learning_rate <= train.learning_rate,
            "train.min_learning_rate: expected 0 to train.learning_rate (", train.learning_rate,
            "), got ", train.min_learning_rate);
  LTE_CHECK(train.weight_decay >= 0, "train.weight_decay: expected 0 or more, got ",
            train.weight_decay);
  LTE_CHECK(train.adam_epsilon > 0, "train.adam_epsilon: expected a positive number, got ",
            train.adam_epsilon);
  LTE_CHECK(train.decay_share > 0 && train.decay_share <= 1,
            "train.decay_share: expected above 0 to 1, got ", train.decay_share);
  LTE_CHECK(train.clip_norm >= 0, "train.clip_norm: expected 0 (off) or more, got ",
            train.clip_norm);
  LTE_CHECK(train.ema_decay >= 0 && train.ema_decay < 1,
            "train.ema_decay: expected 0 (off) to below 1, got ", train.ema_decay);
  LTE_CHECK(train.init_except.empty() || !train.init_weights.empty(),
            "train.init_except: has no meaning without train.init_weights (--init-weights)");
  LTE_CHECK(train.init_rate >= 0 && train.init_rate <= 1,
            "train.init_rate: expected 0 (they are frozen) to 1, got ", train.init_rate);
  LTE_CHECK(train.init_rate == 1 || !train.init_weights.empty(),
            "train.init_rate: has no meaning without train.init_weights (--init-weights)");
}

OptimConfig read_optim(const Config& config) {
  OptimConfig train;
  config.read("steps", &train.steps);
  config.read("scenes_per_step", &train.scenes_per_step);
  config.read("scenes_per_pass", &train.scenes_per_pass);
  config.read("learning_rate", &train.learning_rate);
  config.read("min_learning_rate", &train.min_learning_rate);
  config.read("warmup_steps", &train.warmup_steps);
  config.read("decay_share", &train.decay_share);
  config.read("weight_decay", &train.weight_decay);
  config.read("adam_epsilon", &train.adam_epsilon);
  config.read("optimizer", &train.optimizer, kOptimizerNames);
  config.read("clip_norm", &train.clip_norm);
  config.read("ema_decay", &train.ema_decay);
  config.read("log_every", &train.log_every);
  config.read("checkpoint_every", &train.checkpoint_every);
  config.read("keep_checkpoints", &train.keep_checkpoints);
  config.read("validate_every", &train.validate_every);
  config.read("validation_scenes", &train.validation_scenes);
  config.read("validation_queries", &train.validation_queries);
  config.read("autocast", &train.autocast, kAutocastNames);
  config.read("preview_every", &train.preview_every);
  config.read("timeout_s", &train.timeout_s);
  config.read("init_weights", &train.init_weights);
  config.read("init_except", &train.init_except);
  config.read("init_rate", &train.init_rate);
  check_optim(train);
  return train;
}

nn::LossConfig read_loss(const Config& config) {
  nn::LossConfig loss;
  config.read("epsilon", &loss.epsilon);
  config.read("detach_denominator", &loss.detach_denominator);
  config.read("space", &loss.space);
  LTE_CHECK(loss.epsilon > 0, "loss.epsilon: expected a positive number, got ", loss.epsilon);
  return loss;
}

}  // namespace

TrainConfig TrainConfig::read(const Config& config) {
  TrainConfig out;
  config.read("seed", &out.seed);
  config.read("output", &out.output);
  out.data = read_data(config.at("data"));
  out.augment = read_augment(config.at("augment"));
  out.train = read_optim(config.at("train"));
  const Config loss = config.at("loss");
  out.loss = read_loss(loss);
  const Config model = config.at("model");
  out.has_scale = model.has("scale");
  out.has_output_mean = model.has("output_mean");
  out.model = nn::ModelConfig::read(model);
  loss.read("irradiance_weight", &out.irradiance_weight);
  LTE_CHECK(out.irradiance_weight >= 0 && std::isfinite(out.irradiance_weight),
            "loss.irradiance_weight: expected 0 (off) or more, got ", out.irradiance_weight);
  LTE_CHECK(out.irradiance_weight == 1 || out.model.predicts_radiance(),
            "loss.irradiance_weight: has no meaning without a radiance decoder "
            "(model.radiance_lobes)");
  config.finish();
  return out;
}

double rate_factor(const OptimConfig& config, const std::string& parameter) {
  if (config.init_weights.empty()) return 1;
  const bool fresh =
      std::any_of(config.init_except.begin(), config.init_except.end(),
                  [&](const std::string& prefix) { return parameter.starts_with(prefix); });
  return fresh ? 1 : config.init_rate;
}

std::vector<std::string> model_differences(const nn::ModelConfig& now,
                                           const nn::ModelConfig& before) {
  std::vector<std::string> texts;
  for (const auto& [key, value, old] : nn::differences(now, before)) {
    if (key != "scale" && key != "output_mean")
      texts.push_back(concat(key, " (", value, ", was ", old, ")"));
  }
  return texts;
}

}  // namespace lte::train
