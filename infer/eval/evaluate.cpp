#include "infer/eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "infer/eval/baselines/denoised_paths.h"
#include "infer/eval/measure/embed_sample.h"
#include "infer/eval/measure/eval_points.h"
#include "infer/eval/measure/network_and_paths.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/progress.h"
#include "lte/data/light_groups.h"
#include "lte/data/sample_rows.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {
namespace {

constexpr double kSameScale = 1e-6;

std::string few_paths_row(int paths) { return concat("path_tracing_", paths); }

std::string denoised_row(int paths) { return few_paths_row(paths) + "_denoised"; }

/// The network's answer combined with as many paths, denoised.
std::string both_row(int paths) { return concat("neural_and_", paths, "_denoised"); }

/// Paths a pixel of the pictures that views may have, most first.
std::vector<int> traced_paths() {
  std::vector<int> out{static_cast<int>(kPathsStored)};
  out.insert(out.end(), data::kFewPaths.begin(), data::kFewPaths.end());
  return out;
}

/// The network's indirect irradiance over the emission scalar.
std::vector<Rgb> neural(const runtime::SceneEmbedding& network, const EvalPoints& points) {
  return data::sum_groups(network.decode(points.queries), 1, 1 / network.mean_emission());
}

using Predictions = std::vector<std::pair<std::string, std::vector<Rgb>>>;

/// All predictors of one scene.
struct Predictors {
  const runtime::SceneEmbedding& network;
  const Baselines& baselines;

  Predictions predict(const EvalPoints& points, double* decode_seconds) const {
    Predictions out;
    const Timer timer;
    out.emplace_back("neural", neural(network, points));
    *decode_seconds += timer.seconds();
    if (!points.path_traced.empty()) out.emplace_back(kPathTraced, points.path_traced);
    for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
      if (!points.path_traced_few[i].empty())
        out.emplace_back(few_paths_row(data::kFewPaths[i]), points.path_traced_few[i]);
    }
    if (auto light = network.light_prior(points.queries); !light.empty()) {
      out.emplace_back("light_cache", data::sum_groups(light, 1, 1 / network.mean_emission()));
    }
    const auto mean = static_cast<float>(baselines.mean);
    out.emplace_back("constant_mean",
                     std::vector<Rgb>(points.queries.position.size(), {mean, mean, mean}));
    return out;
  }
};

/// Path tracing with a denoiser, by itself and combined with the network, the first row: rows that
/// views alone have.
void add_denoised(const image::Denoiser& denoiser, const data::View& view, Predictions* rows) {
  Predictions denoised;
  const std::vector<Rgb>& network = rows->front().second;
  for (const int paths : traced_paths()) {
    const auto traced =
        std::ranges::find(*rows, few_paths_row(paths), &Predictions::value_type::first);
    if (traced == rows->end()) continue;
    std::vector<Rgb> clean = denoised_paths(denoiser, view, traced->second);
    denoised.emplace_back(both_row(paths), combine(view, network, clean, paths));
    denoised.emplace_back(denoised_row(paths), std::move(clean));
  }
  std::move(denoised.begin(), denoised.end(), std::back_inserter(*rows));
}

/// Scores of one view, added up over the views of a scene; the caller divides.
class ViewSums {
 public:
  void add(const Predictions& predictions, const ViewPixels& pixels, std::span<const Rgb> seen,
           const data::View& view) {
    if (pixels.position.empty()) return;
    const ReferenceNoise noise = pixels.points.noise();
    noise_.mse += noise.mse;
    noise_.relmse += noise.relmse;
    ++views_;
    for (const auto& [name, values] : predictions) {
      const ViewScore score =
          score_view(values, pixels.points.reference, seen, view.mask, view.width, view.height);
      std::pair<ViewScore, int>& sum = sums_[name];
      for (size_t k = 0; k < score.size(); ++k) sum.first[k] += score[k];
      ++sum.second;
    }
  }

  /// Mean over the views that show anything.
  ReferenceNoise noise() const {
    const double count = std::max(1, views_);
    return {noise_.mse / count, noise_.relmse / count};
  }

  /// Mean scores of a predictor; nothing if no view has it.
  std::optional<ViewScore> mean(const std::string& name) const {
    const auto found = sums_.find(name);
    if (found == sums_.end()) return std::nullopt;
    auto [out, count] = found->second;
    for (double& value : out) value /= count;
    return out;
  }

  void store(Scores* scores) const {
    for (auto& [name, score] : *scores) score.views = mean(name).value_or(Score().views);
  }

 private:
  std::map<std::string, std::pair<ViewScore, int>> sums_;
  ReferenceNoise noise_;
  int views_ = 0;
};

/// Adds rows of fewer paths after that of 64, if it is there, and those with a denoiser. The former
/// are derived from that of 64, except for views where the data has traced ones.
void add_fewer_paths(const ReferenceNoise& points, const ViewSums& views, Scores* scores) {
  const auto found = std::find_if(scores->begin(), scores->end(),
                                  [](const auto& entry) { return entry.first == kPathTraced; });
  if (found == scores->end()) return;
  const Score at_64 = found->second;
  Scores rows;
  for (const int paths : data::kFewPaths) {
    const std::string name = few_paths_row(paths);
    Score score = derived_path_tracing(at_64, points, views.noise(), paths);
    score.views = views.mean(name).value_or(score.views);
    rows.emplace_back(name, score);
  }
  for (const auto& row : {denoised_row, both_row}) {
    for (const int paths : traced_paths()) {
      const auto seen = views.mean(row(paths));
      if (!seen) continue;
      Score score;
      score.views = *seen;
      rows.emplace_back(row(paths), score);
    }
  }
  scores->insert(found + 1, rows.begin(), rows.end());
}

SceneResult evaluate_scene(const EvalSettings& settings, const data::SceneSample& sample,
                           const runtime::Network& network, const Baselines& baselines,
                           const image::Denoiser& denoiser) {
  SceneResult result;
  result.name = sample.name;
  result.points = sample.query_points();
  result.views = static_cast<int64_t>(sample.views.size());
  const Timer timer;
  const runtime::SceneEmbedding embedding = embed_sample(sample, network, settings.memory);
  result.encode_seconds = timer.seconds();
  result.radiance = embedding.mean_emission();
  result.path_variance = single_path_variance(sample, result.radiance);
  result.paths = static_cast<double>(sample.rays);

  const EvalPoints points = query_eval_points(sample, result.radiance);
  result.reference_noise = points.noise().mse;
  const Predictors predictors{embedding, baselines};
  for (const auto& [name, values] : predictors.predict(points, &result.decode_seconds)) {
    result.scores.emplace_back(name, Score());
    result.scores.back().second.points = score_points(values, points.reference);
  }
  ViewSums sums;
  for (size_t k = 0; k < sample.views.size(); ++k) {
    const data::View& view = sample.views[k];
    const ViewPixels pixels(view, sample.light_groups, result.radiance);
    Predictions predictions = predictors.predict(pixels.points, &result.decode_seconds);
    if (denoiser.is_oidn()) add_denoised(denoiser, view, &predictions);
    const std::vector<Rgb>& reference = pixels.points.reference;
    sums.add(predictions, pixels,
             settings.denoise_references ? denoised_paths(denoiser, view, reference) : reference,
             view);
    if (settings.on_view) {
      settings.on_view({sample.name, static_cast<int>(k), view, pixels.points.reference,
                        predictions.front().second, pixels.points.path_traced});
    }
  }
  sums.store(&result.scores);
  result.views_noise = sums.noise().mse;
  add_fewer_paths(points.noise(), sums, &result.scores);
  return result;
}

VarianceCheck check_variance(const std::vector<SceneResult>& scenes) {
  double at_64 = 0, at_reference = 0, single = 0, paths = 0;
  for (const SceneResult& scene : scenes) {
    const Score* const path_traced = find_score(scene.scores, kPathTraced);
    if (!path_traced) continue;
    at_64 += path_traced->points[0] - scene.reference_noise;
    at_reference += scene.reference_noise;
    single += scene.path_variance;
    paths += scene.paths / static_cast<double>(scenes.size());
  }
  constexpr double kMinSpan = 1e-6;
  // NaN without such scenes, and an exponent of NaN where the reference has 64 paths too.
  const double span = std::log(paths / kPathsStored);
  return {kPathsStored * at_64 / single,
          std::abs(span) > kMinSpan ? std::log(at_64 / at_reference) / span : std::nan("")};
}

/// Fills in the figures over all scenes.
void summarize(EvalResult* result) {
  std::vector<Scores> scores;
  std::vector<SceneErrors> errors;
  for (const SceneResult& scene : result->scenes) {
    scores.push_back(scene.scores);
    errors.push_back({scene.scores, scene.reference_noise, scene.views_noise});
  }
  const Bootstrap bootstrap(scores.size(), result->bootstrap);
  result->mean = mean_scores(scores);
  result->median = median_scores(scores);
  result->mean_interval = mean_intervals(scores, bootstrap);
  result->median_interval = median_intervals(scores, bootstrap);
  result->equal_samples = all_equal_samples(errors, bootstrap);
  result->variance_check = check_variance(result->scenes);
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

EvalResult evaluate(const EvalSettings& settings, const runtime::Network& network,
                    const Baselines& baselines) {
  const data::DatasetInfo info = data::read_dataset_info(settings.data);
  LTE_CHECK(std::abs(info.scale - network.config().scale) <= kSameScale * network.config().scale,
            settings.data.string(), ": data of scale ", info.scale,
            " m does not go with a model of scale ", network.config().scale,
            " m: evaluate on a data set generated with the model's scale");
  const std::vector<data::DatasetEntry> entries = data::entries_of(info, settings.split);
  LTE_CHECK(!entries.empty(), settings.data.string(), ": no scenes of split ",
            data::split_name(settings.split), " (it has: ", splits_there(info), ")");
  if (info.suns && !network.metadata().suns) {
    log_warning(settings.data.string(),
                ": scenes with directional lights, but the model was trained without any");
  }
  const image::Denoiser denoiser(settings.denoise_references ? image::DenoiseBy::OpenImageDenoise
                                                             : image::DenoiseBy::Best);
  EvalResult result;
  result.split = data::split_name(settings.split);
  result.bootstrap = settings.bootstrap;
  Progress progress("evaluating", static_cast<int64_t>(entries.size()), "scenes");
  for (const data::DatasetEntry& entry : entries) {
    data::SceneSample sample = data::read_scene_sample(data::scene_path(settings.data, entry.name));
    data::drop_idle_queries(&sample);
    thin_for(network, settings.scene_points, &sample);
    sample.name = entry.name;
    result.scenes.push_back(evaluate_scene(settings, sample, network, baselines, denoiser));
    if (settings.on_scene) settings.on_scene();
    progress.advance();
  }
  summarize(&result);
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
    data::drop_idle_queries(&sample);
    fit.add(sample);
    progress.advance();
  }
  return fit.finish();
}

}  // namespace lte::infer
