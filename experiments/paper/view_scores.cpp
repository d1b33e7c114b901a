#include "experiments/paper/view_scores.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/eval/baselines/denoised_paths.h"
#include "infer/eval/measure/bootstrap.h"
#include "infer/eval/measure/equal_samples.h"
#include "infer/eval/measure/scores.h"
#include "lte/base/check.h"
#include "lte/data/sample_rows.h"

namespace lte::experiments {
namespace {

constexpr size_t kMse = 0, kSsim = 2, kFlip = 4;  // of infer::kViewMetrics
constexpr const char* kAnswers = "answers";

/// Area-weighted mean emission over points and channels; 1 for a scene without emission.
double emission_scalar(const data::SceneSample& sample) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < sample.scene_emission.size(); ++i) {
    const Rgb& e = sample.scene_emission[i];
    sum += sample.scene_area[i] * (double{e.x} + e.y + e.z) / 3;
    area += sample.scene_area[i];
  }
  return sum > 0 ? sum / area : 1;
}

/// The mean over the views of a scene.
infer::SceneErrors score_scene(const EvalScene& scene, const image::Denoiser& denoiser,
                               const AnswerView& answer, infer::Scores* scores) {
  infer::ViewScore sum{}, traced_sum{};
  double noise = 0, views = 0;
  for (const data::View& view : scene.sample.views) {
    const infer::ViewPixels pixels(view, scene.sample.light_groups, scene.radiance);
    if (pixels.position.empty()) continue;
    const std::vector<Rgb>& reference = pixels.points.reference;
    const std::vector<Rgb> seen = infer::denoised_paths(denoiser, view, reference);
    const auto add = [&](const std::vector<Rgb>& values, infer::ViewScore* to) {
      const infer::ViewScore score =
          infer::score_view(values, reference, seen, view.mask, view.width, view.height);
      for (size_t k = 0; k < score.size(); ++k) (*to)[k] += score[k];
    };
    add(answer(scene, view, pixels), &sum);
    if (!pixels.points.path_traced.empty()) add(pixels.points.path_traced, &traced_sum);
    noise += pixels.points.noise().mse;
    ++views;
  }
  if (views == 0) return {*scores, 0, 0};
  infer::Score ours, traced;
  for (size_t k = 0; k < sum.size(); ++k) {
    ours.views[k] = sum[k] / views;
    traced.views[k] = traced_sum[kMse] > 0 ? traced_sum[k] / views : infer::kMissing;
  }
  *scores = {{kAnswers, ours}, {infer::kPathTraced, traced}};
  return {*scores, 0, noise / views};
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace

std::vector<EvalScene> read_eval_scenes(const std::filesystem::path& data, data::Split split) {
  std::vector<EvalScene> scenes;
  for (const data::DatasetEntry& entry : data::entries_of(data::read_dataset_info(data), split)) {
    EvalScene scene;
    scene.path = data::scene_path(data, entry.name);
    scene.sample = data::read_scene_sample(scene.path);
    scene.sample.name = entry.name;
    data::drop_idle_queries(&scene.sample);
    scene.radiance = emission_scalar(scene.sample);
    scenes.push_back(std::move(scene));
  }
  LTE_CHECK(!scenes.empty(), data.string(), ": no scenes of split ", data::split_name(split));
  return scenes;
}

nlohmann::json score_views(const std::vector<EvalScene>& scenes, const AnswerView& answer) {
  const image::Denoiser denoiser(image::DenoiseBy::OpenImageDenoise);
  std::vector<infer::Scores> scores(scenes.size());
  std::vector<infer::SceneErrors> errors;
  for (size_t i = 0; i < scenes.size(); ++i) {
    errors.push_back(score_scene(scenes[i], denoiser, answer, &scores[i]));
    LTE_CHECK(!scores[i].empty(), scenes[i].path.string(), ": has no view to compare");
  }
  const infer::Bootstrap bootstrap(scenes.size(), {});
  const infer::ViewScore mean = infer::find_score(infer::mean_scores(scores), kAnswers)->views;
  const infer::ScoreInterval bounds = infer::mean_intervals(scores, bootstrap).front().second;
  const auto worth = infer::all_equal_samples(errors, bootstrap);
  return {{"scenes", scenes.size()},
          {"mse", number(mean[kMse])},
          {"interval", {number(bounds.low.views[kMse]), number(bounds.high.views[kMse])}},
          {"ssim", number(mean[kSsim])},
          {"flip", number(mean[kFlip])},
          {"worth", worth.empty() ? nlohmann::json() : number(worth.front().views.all)}};
}

std::vector<std::vector<EvalScene>> read_tests(const std::string& test,
                                               const std::vector<std::string>& also) {
  std::vector<std::vector<EvalScene>> out{read_eval_scenes(test, data::Split::Test)};
  for (const std::string& other : also) out.push_back(read_eval_scenes(other, data::Split::Test));
  return out;
}

nlohmann::json score_tests(
    const std::vector<std::vector<EvalScene>>& tests,
    const std::function<nlohmann::json(const std::vector<EvalScene>&)>& score) {
  nlohmann::json json = score(tests.front());
  json["also"] = nlohmann::json::array();
  for (size_t i = 1; i < tests.size(); ++i) json["also"].push_back(score(tests[i]));
  return json;
}

}  // namespace lte::experiments
