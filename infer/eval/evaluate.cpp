#include "infer/eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "infer/eval/measure/drawn_to_paths.h"
#include "infer/eval/measure/embed_sample.h"
#include "infer/eval/measure/equal_paths.h"
#include "infer/eval/measure/eval_points.h"
#include "infer/eval/rivals/denoised_paths.h"
#include "infer/eval/rivals/probes.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/progress.h"
#include "lte/data/sample_rows.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {
namespace {

constexpr double kSameScale = 1e-6;

constexpr const char* kEqualPathsRow = "equal_paths_denoised";

std::string few_paths_row(int paths) { return concat("path_tracing_", paths); }

std::string denoised_row(int paths) { return few_paths_row(paths) + "_denoised"; }

/// The network's answer, drawn towards as many paths, denoised.
std::string both_row(int paths) { return concat("neural_and_", paths, "_denoised"); }

/// Paths a pixel of the pictures that views may have, most first.
std::vector<int> traced_paths() {
  std::vector<int> out{static_cast<int>(kPathsStored)};
  out.insert(out.end(), data::kFewPaths.begin(), data::kFewPaths.end());
  return out;
}

/// The network's indirect irradiance over the emission scalar, summed over embeddings of the
/// scene's light. A model of total irradiance is compared on the same quantity, from which the
/// reference's direct light is subtracted.
std::vector<Rgb> neural(std::span<const runtime::SceneEmbedding> lights, double mean_emission,
                        const EvalPoints& points) {
  std::vector<Rgb> out(points.queries.position.size());
  for (const runtime::SceneEmbedding& light : lights) {
    const std::vector<Rgb> part =
        data::sum_groups(light.decode(points.queries), 1, 1 / mean_emission);
    for (size_t i = 0; i < out.size(); ++i) out[i] += part[i];
    if (!light.network().predicts_total() || &light != &lights.back()) continue;
    for (size_t i = 0; i < out.size(); ++i) out[i] = max(out[i] - points.direct[i], Vec3{});
  }
  return out;
}

using Predictions = std::vector<std::pair<std::string, std::vector<Rgb>>>;

/// Everything that predicts in one scene.
struct Predictors {
  const runtime::SceneEmbedding& network;
  const BaselinePredictor& baselines;
  const ProbeField& probes;
  std::span<const runtime::SceneEmbedding> by_light;  ///< luminaires apart; may be empty

  Predictions predict(const EvalPoints& points, double* decode_seconds) const {
    Predictions out;
    const Timer timer;
    out.emplace_back("neural", neural({&network, 1}, network.mean_emission(), points));
    *decode_seconds += timer.seconds();
    if (!by_light.empty())
      out.emplace_back("neural_by_light", neural(by_light, network.mean_emission(), points));
    if (!points.path_traced.empty()) out.emplace_back(kPathTraced, points.path_traced);
    for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
      if (!points.path_traced_few[i].empty())
        out.emplace_back(few_paths_row(data::kFewPaths[i]), points.path_traced_few[i]);
    }
    if (auto light = network.cached_light(points.queries); !light.empty()) {
      out.emplace_back("light_cache", data::sum_groups(light, 1, 1 / network.mean_emission()));
    }
    out.emplace_back("constant_mean", baselines.constant_mean(points.queries));
    out.emplace_back("nearest_point", baselines.nearest_point(points.queries));
    out.emplace_back("blurred_direct", baselines.blurred_direct(points.queries));
    if (probes.size() > 0)
      out.emplace_back("irradiance_probes", probes.interpolate(points.queries));
    out.emplace_back("direct_only", std::vector<Rgb>(points.queries.position.size()));
    return out;
  }
};

/// Path tracing with a denoiser, by itself and beside the network, the first row: rows that views
/// alone have.
void add_denoised(const image::Denoiser& denoiser, const data::View& view, Predictions* rows) {
  Predictions denoised;
  const std::vector<Rgb>& network = rows->front().second;
  for (const int paths : traced_paths()) {
    const auto traced =
        std::ranges::find(*rows, few_paths_row(paths), &Predictions::value_type::first);
    if (traced == rows->end()) continue;
    std::vector<Rgb> clean = denoised_paths(denoiser, view, traced->second);
    denoised.emplace_back(both_row(paths), drawn_to_paths(view, network, clean, paths));
    denoised.emplace_back(denoised_row(paths), std::move(clean));
  }
  std::move(denoised.begin(), denoised.end(), std::back_inserter(*rows));
}

/// Scores of one view, added up over the views of a scene; the caller divides.
class ViewSums {
 public:
  void add(const Predictions& predictions, const ViewPixels& pixels, const data::View& view) {
    if (pixels.position.empty()) return;
    const ReferenceNoise noise = pixels.points.noise();
    noise_.mse += noise.mse;
    noise_.relmse += noise.relmse;
    ++views_;
    for (const auto& [name, values] : predictions) {
      const ViewScore score =
          score_view(values, pixels.points.reference, view.mask, view.width, view.height);
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

/// Paths that a renderer traces for the light that the network reads: on both sides of every point
/// that does not emit.
double light_paths(const data::SceneSample& sample, const data::DatasetInfo& info,
                   const runtime::Network& network) {
  if (network.light_request().depth == 0) return 0;
  const auto lit = std::count_if(sample.scene_emission.begin(), sample.scene_emission.end(),
                                 [](const Rgb& value) { return max_component(value) <= 0; });
  return 2.0 * static_cast<double>(lit) * info.light_paths;
}

/// Adds the row of a denoiser that has the paths which the network's light takes, spread over one
/// view; none where they are fewer or more than views were traced with.
void add_equal_paths(double paths, const data::SceneSample& sample, const ViewSums& views,
                     Scores* scores) {
  if (paths <= 0 || sample.views.empty()) return;
  double pixels = 0;
  for (const data::View& view : sample.views)
    pixels += static_cast<double>(view.mask.size()) / static_cast<double>(sample.views.size());
  std::map<int, ViewScore> denoised;
  for (const int count : traced_paths()) {
    if (const auto seen = views.mean(denoised_row(count))) denoised[count] = *seen;
  }
  const std::optional<ViewScore> views_score = score_between(denoised, paths / pixels);
  if (!views_score) return;
  Score score;
  score.views = *views_score;
  scores->emplace_back(kEqualPathsRow, score);
}

/// The probes that could be baked instead of preparing the network: in the time of the encoding,
/// and with the paths that its light estimates take.
int64_t probe_count(const EvalSettings& settings, const data::SceneSample& sample,
                    double encode_seconds, double estimate_paths) {
  if (settings.probe_rate <= 0) return settings.probes;
  const auto paths = static_cast<double>(std::max<int64_t>(1, sample.rays));
  return std::max<int64_t>(
      1, std::llround((encode_seconds * settings.probe_rate + estimate_paths) / paths));
}

SceneResult evaluate_scene(const EvalSettings& settings, const data::DatasetInfo& info,
                           const data::SceneSample& sample, const runtime::Network& network,
                           const Baselines& fitted, const image::Denoiser& denoiser) {
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

  const BaselinePredictor baselines(fitted, sample, result.radiance);
  const EvalPoints points = query_eval_points(sample, result.radiance);
  const double estimate_paths = light_paths(sample, info, network);
  const ProbeField probes(points.queries, points.reference,
                          probe_count(settings, sample, result.encode_seconds, estimate_paths));
  result.probes = probes.size();
  result.reference_noise = points.noise().mse;
  std::vector<runtime::SceneEmbedding> by_light;
  if (settings.light_by_light) by_light = embed_by_light(sample, network, settings.memory);
  const Predictors predictors{embedding, baselines, probes, by_light};
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
    sums.add(predictions, pixels, view);
    if (settings.on_view) {
      settings.on_view({sample.name, static_cast<int>(k), view, pixels.points.reference,
                        predictions.front().second, pixels.points.path_traced});
    }
  }
  sums.store(&result.scores);
  result.views_noise = sums.noise().mse;
  add_fewer_paths(points.noise(), sums, &result.scores);
  add_equal_paths(estimate_paths, sample, sums, &result.scores);
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
  constexpr double kLeastSpan = 1e-6;
  // NaN without such scenes, and an exponent of NaN where the reference has 64 paths too.
  const double span = std::log(paths / kPathsStored);
  return {kPathsStored * at_64 / single,
          std::abs(span) > kLeastSpan ? std::log(at_64 / at_reference) / span : std::nan("")};
}

/// What is said of all scenes together.
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
  const image::Denoiser denoiser;
  EvalResult result;
  result.split = data::split_name(settings.split);
  result.bootstrap = settings.bootstrap;
  Progress progress("evaluating", static_cast<int64_t>(entries.size()), "scenes");
  for (const data::DatasetEntry& entry : entries) {
    data::SceneSample sample = data::read_scene_sample(data::scene_path(settings.data, entry.name));
    data::drop_idle_queries(&sample);
    thin_for(network, settings.scene_points, &sample);
    sample.name = entry.name;
    result.scenes.push_back(evaluate_scene(settings, info, sample, network, baselines, denoiser));
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
