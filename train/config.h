// Everything that fixes a training run: `data:`, `augment:`, `train:`, `loss:` and `model:` of the
// YAML configuration. docs/training-keys.md explains each key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/config.h"
#include "lte/nn/blocks/precision.h"
#include "lte/nn/config.h"
#include "lte/nn/loss_config.h"

namespace lte::train {

/// A scene that cannot be used ends a run, or is skipped.
enum class BadScene { Fail, Skip };

struct DataConfig {
  std::string root;                  ///< directory with dataset.json
  int64_t scene_points = 20'000;     ///< M; a file with more is subsampled afresh each step; 0: all
  int64_t queries_per_scene = 8192;  ///< drawn afresh each step; 0: all
  int64_t cache_mb = 4096;           ///< memory for scenes kept between steps
  BadScene on_bad_scene = BadScene::Fail;  ///< fail | skip
  std::string solved_light;  ///< folder that keeps light solved on scene points; empty: none
  // Of models with a radiance decoder.
  int64_t radiance_points = 128;     ///< points of a scene with incident radiance; 0: all
  int64_t radiance_directions = 64;  ///< of each of them; 0: all
};

/// The axis about which scenes are turned; Y is the vertical.
enum class Rotation { None, Vertical };

constexpr EnumNames<BadScene, 2> enum_names(BadScene) {
  return {{{BadScene::Fail, "fail"}, {BadScene::Skip, "skip"}}};
}
constexpr EnumNames<Rotation, 2> enum_names(Rotation) {
  return {{{Rotation::None, "none"}, {Rotation::Vertical, "vertical"}}};
}

/// Exact symmetries of light transport (augment.h); each is off at the value in brackets.
struct AugmentConfig {
  Rotation rotate = Rotation::Vertical;  ///< none | vertical [none]
  bool mirror = true;                    ///< across a vertical plane [false]
  bool permute_colors = true;            ///< permutes R, G and B [false]
  double gain = 4.0;  ///< each luminaire's brightness times g, log-uniform in [1/gain, gain] [1]
  double tint = 2.0;  ///< the same for each channel of each luminaire by itself [1]
  /// Point dropout: the number of a scene's points is divided by a number drawn log-uniformly from
  /// [1, point_dropout] [1].
  double point_dropout = 1.0;
};

enum class OptimizerKind { AdamW, Muon };  ///< of matrices between features; AdamW moves all else

struct OptimConfig {
  int64_t steps = 2'000'000;
  int64_t scenes_per_step = 3;
  int64_t scenes_per_pass = 1;      ///< of them that go through the network at once
  double learning_rate = 2e-4;      ///< the highest one, after warm-up
  double min_learning_rate = 2e-6;  ///< the cosine's floor, reached at the last step
  int64_t warmup_steps = 2000;
  /// Share of the steps, the last ones, over which the rate falls; before, it is constant. 1: all
  /// after warm-up.
  double decay_share = 1.0;
  double weight_decay = 1e-4;  ///< of matrices and filters; biases and norms have none
  double adam_epsilon = 1e-8;  ///< added to the root of the second moment
  OptimizerKind optimizer = OptimizerKind::AdamW;
  double clip_norm = 1.0;             ///< limit of the whole gradient's norm; 0: no clipping
  double ema_decay = 0.0;             ///< of the averaged weights; 0: none are kept
  int64_t log_every = 50;             ///< steps between lines of log.jsonl
  int64_t checkpoint_every = 1000;    ///< steps
  int64_t keep_checkpoints = 2;       ///< the last ones that stay; the best one stays beside them
  int64_t validate_every = 1000;      ///< steps
  int64_t validation_scenes = 32;     ///< the first ones of the split; 0: all
  int64_t validation_queries = 8192;  ///< of each scene, the same every time; 0: all
  int64_t preview_every = 5000;       ///< steps between pictures of validation views; 0: none
  int64_t timeout_s = 600;            ///< how long one process may keep the others waiting
  std::string init_weights;           ///< file whose weights a new run starts from; empty: none
  std::vector<std::string> init_except;  ///< prefixes of parameters that stay fresh all the same
  /// Factor on the learning rate of parameters that init_weights gave; 0: they are frozen.
  double init_rate = 1.0;
  nn::Precision autocast = nn::Precision::Fp32;  ///< of products in training steps: none | bf16
};

struct TrainConfig {
  uint64_t seed = 1;
  std::string output;  ///< run directory
  DataConfig data;
  AugmentConfig augment;
  OptimConfig train;
  nn::LossConfig loss;
  /// The key loss.irradiance_weight: of the irradiance loss where the model predicts radiance too,
  /// whose loss has the weight 1. 0: irradiance is not computed.
  double irradiance_weight = 1;
  nn::ModelConfig model;
  bool has_scale = false;        ///< model.scale is given, and must be the data set's
  bool has_output_mean = false;  ///< model.output_mean is given, and is taken rather than measured

  /// Reads every key and refuses those it does not know.
  /// @throws lte::Error naming the key: unknown, ill-typed or out of range.
  static TrainConfig read(const Config& config);
};

/// The factor on the learning rate of a parameter: OptimConfig::init_rate, or 1 where it starts
/// fresh.
double rate_factor(const OptimConfig& config, const std::string& parameter);

/// @return the keys under `model:` in which two configurations differ, as "channels (64, was 128)";
/// without scale and output_mean, which come from the data
std::vector<std::string> model_differences(const nn::ModelConfig& now,
                                           const nn::ModelConfig& before);

}  // namespace lte::train
