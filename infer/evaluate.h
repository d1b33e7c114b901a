// Error of a model and of the baselines on one split of a baked data set. Needs neither Embree nor
// the scene files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "infer/baselines.h"
#include "infer/predictor.h"
#include "infer/scores.h"
#include "lte/data/dataset.h"

namespace lte::infer {

struct SceneResult {
  std::string name;
  double radiance = 1;  ///< the emission scalar that irradiance was divided by
  double reference_noise =
      0;  ///< mean variance of the normalized reference at the points: the floor of any MSE
  int64_t points = 0, views = 0;
  double encode_seconds = 0, decode_seconds = 0;
  Scores scores;
};

struct EvalResult {
  std::string split;
  std::vector<SceneResult> scenes;
  Scores mean, median;
};

/// Indirect irradiance over the emission scalar at the pixels of a view whose mask is set.
struct ViewPicture {
  const std::string& scene;
  int index;
  const data::View& view;
  std::span<const Rgb> reference, neural;
};
using ViewSink = std::function<void(const ViewPicture&)>;

struct EvalSettings {
  std::filesystem::path data;
  data::Split split = data::Split::Test;
  ViewSink on_view;                ///< may be empty
  std::function<void()> on_scene;  ///< after each scene; may be empty
};

/// @throws lte::Error if the split is empty (naming those that are not), or if data and model have
/// different scales s.
EvalResult evaluate(const EvalSettings& settings, Predictor* predictor, const Baselines& baselines);

/// Baselines of the training split of `directory`.
/// @throws lte::Error naming the folder if it has no training scenes.
Baselines fit_baselines(const std::filesystem::path& directory);

}  // namespace lte::infer
