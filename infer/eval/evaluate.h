// Error of a model and of the baselines on one split of a baked data set. Needs neither Embree nor
// the scene files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "infer/eval/baselines/baselines.h"
#include "infer/eval/measure/bootstrap.h"
#include "infer/eval/measure/equal_samples.h"
#include "infer/eval/measure/scores.h"
#include "lte/data/dataset.h"
#include "lte/runtime/memory_limit.h"
#include "lte/runtime/network.h"

namespace lte::infer {

struct SceneResult {
  std::string name;
  double radiance = 1;  ///< the emission scalar that irradiance was divided by
  /// Mean variance of the normalized reference at the points: the floor of any MSE.
  double reference_noise = 0;
  double views_noise = 0;    ///< the same over the views; 0 without any
  double path_variance = 0;  ///< of a single path at the points, by the spread of the reference
  double paths = 0;          ///< number behind a point of the reference
  int64_t points = 0, views = 0;
  double encode_seconds = 0, decode_seconds = 0;
  Scores scores;
};

/// How well the variance of path tracing follows 1/n at the points, where the paths of the
/// reference are known.
struct VarianceCheck {
  /// The variance of one path as the 64-path estimate shows it, over that as the spread of the
  /// reference shows it: 1 if variance falls as 1/n. NaN without path_tracing_64.
  double ratio;
  double exponent;  ///< p of a variance that falls as n^−p between 64 paths and the reference's
};

struct EvalResult {
  std::string split;
  std::vector<SceneResult> scenes;
  Scores mean, median;
  BootstrapSettings bootstrap;
  ScoreIntervals mean_interval, median_interval;
  std::vector<PredictorSamples> equal_samples;
  VarianceCheck variance_check{};
};

/// Indirect irradiance over the emission scalar at the pixels of a view whose mask is set.
struct ViewPicture {
  const std::string& scene;
  int index;
  const data::View& view;
  std::span<const Rgb> reference, neural;
  std::span<const Rgb> path_traced;  ///< with 64 paths; empty if the data has none
};
using ViewSink = std::function<void(const ViewPicture&)>;

struct EvalSettings {
  std::filesystem::path data;
  data::Split split = data::Split::Test;
  int64_t scene_points = 0;  ///< shown to the model; 0: as many as in training
  /// SSIM and FLIP are of references that Open Image Denoise has cleaned.
  bool denoise_references = false;
  BootstrapSettings bootstrap;
  runtime::MemoryLimit memory;
  ViewSink on_view;                ///< may be empty
  std::function<void()> on_scene;  ///< after each scene; may be empty
};

/// Compares the model and the baselines with the reference in every scene of a split.
/// @throws lte::Error if the split is empty (naming those that are not), if data and model have
///         different scales s, or if references are to be denoised and Open Image Denoise is not
///         there.
EvalResult evaluate(const EvalSettings& settings, const runtime::Network& network,
                    const Baselines& baselines);

/// Fits the baselines on the training split of `directory`.
/// @throws lte::Error naming the folder if it has no training scenes.
Baselines fit_baselines(const std::filesystem::path& directory);

}  // namespace lte::infer
