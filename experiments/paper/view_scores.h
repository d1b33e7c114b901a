// The pictures of a data set as lte_eval compares them, answered by something that is no model of
// lte: the same pixels, units and scores.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "infer/eval/measure/eval_points.h"
#include "lte/data/dataset.h"

namespace lte::experiments {

/// A scene of a split, without the query points and pixels that lte_eval leaves out.
struct EvalScene {
  std::filesystem::path path;
  data::SceneSample sample;
  double radiance = 1;  ///< emission scalar, which irradiance is divided by
};

/// @throws lte::Error if the split is empty
std::vector<EvalScene> read_eval_scenes(const std::filesystem::path& data, data::Split split);

/// Indirect irradiance over the emission scalar at the pixels of a view whose mask is set.
using AnswerView = std::function<std::vector<Rgb>(const EvalScene& scene, const data::View& view,
                                                  const infer::ViewPixels& pixels)>;

/// Scores answers to every view; SSIM and FLIP of references that Open Image Denoise has cleaned.
/// @return  "scenes", "mse", "interval" (95 %), "ssim", "flip", and "worth": paths of equal error,
///          null where the data set has no view of 64 paths
/// @throws lte::Error naming a scene without a view, or if Open Image Denoise is not there
nlohmann::json score_views(const std::vector<EvalScene>& scenes, const AnswerView& answer);

/// The test splits of --test and of each --also: read before a training, so that none is in vain.
/// @throws lte::Error as read_eval_scenes()
std::vector<std::vector<EvalScene>> read_tests(const std::string& test,
                                               const std::vector<std::string>& also);

/// What `score` says of the first of them, and in "also" of the others.
nlohmann::json score_tests(
    const std::vector<std::vector<EvalScene>>& tests,
    const std::function<nlohmann::json(const std::vector<EvalScene>&)>& score);

}  // namespace lte::experiments
