#include "infer/evaluate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/progress.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

constexpr double kSameScale = 1e-6;

/// Points at which predictors are compared. Values are indirect irradiance over the emission
/// scalar.
struct Site {
  QueryPoints queries;
  std::vector<Rgb> reference, direct;
  std::vector<Rgb> path_traced;  ///< empty if the data has none
};

std::vector<Rgb> scaled(std::span<const Rgb> values, double factor) {
  return sum_groups(values, 1, factor);
}

Site point_site(const data::SceneSample& sample, double radiance) {
  Site site;
  site.queries = {sample.query_position, sample.query_normal, sample.query_albedo};
  site.reference = sum_groups(sample.indirect, sample.light_groups, 1 / radiance);
  site.direct = sum_groups(sample.direct, sample.light_groups, 1 / radiance);
  site.path_traced = scaled(sample.path_traced_64, 1 / radiance);
  return site;
}

/// The pixels of a view that show a surface, one after another.
struct ViewPixels {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  Site site;

  ViewPixels(const data::View& view, int64_t groups, double radiance) {
    const auto masked = [&](const std::vector<Vec3>& values) {
      std::vector<Vec3> out;
      for (size_t i = 0; i < values.size(); ++i) {
        if (view.mask[i]) out.push_back(values[i]);
      }
      return out;
    };
    position = masked(view.position), normal = masked(view.normal), albedo = masked(view.albedo);
    site.queries = {position, normal, albedo};
    site.reference = masked(sum_groups(view.indirect, groups, 1 / radiance));
    site.direct = masked(sum_groups(view.direct, groups, 1 / radiance));
    site.path_traced = masked(scaled(view.path_traced_64, 1 / radiance));
  }
  ViewPixels(const ViewPixels&) = delete;
  ViewPixels& operator=(const ViewPixels&) = delete;
};

/// The network's indirect irradiance over the emission scalar. A model of total irradiance is
/// compared on the same quantity: what the reference direct light leaves of it.
std::vector<Rgb> neural(const Predictor& predictor, const Site& site) {
  std::vector<Rgb> out = scaled(predictor.predict(site.queries), 1 / predictor.radiance());
  if (!predictor.predicts_total()) return out;
  for (size_t i = 0; i < out.size(); ++i) out[i] = max(out[i] - site.direct[i], Vec3{});
  return out;
}

using Predictions = std::vector<std::pair<std::string, std::vector<Rgb>>>;

Predictions predict_all(const Predictor& predictor, const BaselinePredictor& baselines,
                        const Site& site, double* decode_seconds) {
  Predictions out;
  const Timer timer;
  out.emplace_back("neural", neural(predictor, site));
  *decode_seconds += timer.seconds();
  if (!site.path_traced.empty()) out.emplace_back("path_tracing_64", site.path_traced);
  out.emplace_back("constant_mean", baselines.constant_mean(site.queries));
  out.emplace_back("nearest_point", baselines.nearest_point(site.queries));
  out.emplace_back("blurred_direct", baselines.blurred_direct(site.queries));
  return out;
}

Score* score_of(Scores* scores, const std::string& name) {
  const auto found = std::find_if(scores->begin(), scores->end(),
                                  [&](const auto& entry) { return entry.first == name; });
  return found == scores->end() ? nullptr : &found->second;
}

/// Scores of one view, added up over the views of a scene; the caller divides.
class ViewSums {
 public:
  void add(const Predictions& predictions, const ViewPixels& pixels, const data::View& view) {
    if (pixels.position.empty()) return;
    for (const auto& [name, values] : predictions) {
      const std::array<double, 4> score =
          score_view(values, pixels.site.reference, view.mask, view.width, view.height);
      std::pair<std::array<double, 4>, int>& sum = sums_[name];
      for (size_t k = 0; k < score.size(); ++k) sum.first[k] += score[k];
      ++sum.second;
    }
  }

  void store(Scores* scores) const {
    for (const auto& [name, sum] : sums_) {
      Score* score = score_of(scores, name);
      if (!score) continue;
      for (size_t k = 0; k < sum.first.size(); ++k) score->views[k] = sum.first[k] / sum.second;
    }
  }

 private:
  std::map<std::string, std::pair<std::array<double, 4>, int>> sums_;
};

SceneResult evaluate_scene(const EvalSettings& settings, const data::SceneSample& sample,
                           Predictor* predictor, const Baselines& fitted) {
  SceneResult result;
  result.name = sample.name;
  result.points = sample.query_points();
  result.views = static_cast<int64_t>(sample.views.size());
  const Timer timer;
  predictor->embed({sample.scene_position, sample.scene_normal, sample.scene_albedo,
                    sample.scene_emission, sample.scene_area});
  result.encode_seconds = timer.seconds();
  result.radiance = predictor->radiance();
  for (const float variance : sample.variance) result.reference_noise += variance;
  result.reference_noise /= static_cast<double>(std::max<size_t>(1, sample.variance.size())) *
                            result.radiance * result.radiance;

  const BaselinePredictor baselines(fitted, sample, result.radiance);
  const Site points = point_site(sample, result.radiance);
  for (const auto& [name, values] :
       predict_all(*predictor, baselines, points, &result.decode_seconds)) {
    result.scores.emplace_back(name, Score());
    result.scores.back().second.points = score_points(values, points.reference);
  }
  ViewSums sums;
  for (size_t k = 0; k < sample.views.size(); ++k) {
    const data::View& view = sample.views[k];
    const ViewPixels pixels(view, sample.light_groups, result.radiance);
    const Predictions predictions =
        predict_all(*predictor, baselines, pixels.site, &result.decode_seconds);
    sums.add(predictions, pixels, view);
    if (settings.on_view) {
      settings.on_view({sample.name, static_cast<int>(k), view, pixels.site.reference,
                        predictions.front().second});
    }
  }
  sums.store(&result.scores);
  return result;
}

/// "train 40, test 8": the splits that have scenes.
std::string splits_there(const data::DatasetInfo& info) {
  std::string out;
  for (const data::Split split : {data::Split::Train, data::Split::Val, data::Split::Test}) {
    const size_t count = data::entries_of(info, split).size();
    if (count > 0) out += concat(out.empty() ? "" : ", ", data::split_name(split), " ", count);
  }
  return out.empty() ? "none" : out;
}

}  // namespace

EvalResult evaluate(const EvalSettings& settings, Predictor* predictor,
                    const Baselines& baselines) {
  const data::DatasetInfo info = data::read_dataset_info(settings.data);
  LTE_CHECK(std::abs(info.scale - predictor->scale()) <= kSameScale * predictor->scale(),
            settings.data.string(), ": data of scale ", info.scale,
            " m does not go with a model of scale ", predictor->scale(),
            " m: evaluate on a data set generated with the model's scale");
  const std::vector<data::DatasetEntry> entries = data::entries_of(info, settings.split);
  LTE_CHECK(!entries.empty(), settings.data.string(), ": no scenes of split ",
            data::split_name(settings.split), " (it has: ", splits_there(info), ")");
  EvalResult result;
  result.split = data::split_name(settings.split);
  std::vector<Scores> scores;
  Progress progress("evaluating", static_cast<int64_t>(entries.size()), "scenes");
  for (const data::DatasetEntry& entry : entries) {
    data::SceneSample sample = data::read_scene_sample(data::scene_path(settings.data, entry.name));
    data::drop_unreached_queries(&sample);
    sample.name = entry.name;
    result.scenes.push_back(evaluate_scene(settings, sample, predictor, baselines));
    scores.push_back(result.scenes.back().scores);
    if (settings.on_scene) settings.on_scene();
    progress.advance();
  }
  result.mean = mean_scores(scores);
  result.median = median_scores(scores);
  return result;
}

Baselines fit_baselines(const std::filesystem::path& directory) {
  const std::vector<data::DatasetEntry> entries =
      data::entries_of(data::read_dataset_info(directory), data::Split::Train);
  LTE_CHECK(!entries.empty(), directory.string(), ": no training scenes to fit baselines on");
  BaselineFit fit;
  Progress progress("fitting baselines", static_cast<int64_t>(entries.size()), "scenes");
  for (const data::DatasetEntry& entry : entries) {
    data::SceneSample sample = data::read_scene_sample(data::scene_path(directory, entry.name));
    data::drop_unreached_queries(&sample);
    fit.add(sample);
    progress.advance();
  }
  return fit.finish();
}

}  // namespace lte::infer
