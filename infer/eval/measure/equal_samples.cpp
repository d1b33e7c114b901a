#include "infer/eval/measure/equal_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lte::infer {
namespace {

constexpr double kMaxPsnr = 100;
constexpr size_t kMse = 0;  // in both lists of metrics

/// The error a/n + r of `paths` paths, with a from the error of 64 paths. Where that error is below
/// the noise r, a is 0.
double at_paths(double at_64, double noise, double paths) {
  return std::max(at_64 - noise, 0.0) * kPathsStored / paths + std::min(noise, at_64);
}

double derived_psnr(double psnr_64, double mse_64, double mse) {
  if (!(mse_64 > 0)) return psnr_64;
  return std::min(psnr_64 + 10 * std::log10(mse_64 / mse), kMaxPsnr);
}

/// The errors of a predictor and of path tracing in each scene, all at points or all in views.
struct Errors {
  std::vector<double> predictor, path_traced, noise;

  double over(std::span<const uint32_t> scenes) const {
    double mse = 0, path_traced_mse = 0, floor = 0;
    for (const uint32_t scene : scenes) {
      if (!std::isfinite(predictor[scene]) || !std::isfinite(path_traced[scene])) continue;
      mse += predictor[scene];
      path_traced_mse += path_traced[scene];
      floor += noise[scene];
    }
    return equal_samples(mse, path_traced_mse, floor);
  }
};

EqualSamples summarize(const Errors& errors, const Bootstrap& bootstrap) {
  EqualSamples out;
  std::vector<uint32_t> all;
  std::vector<double> known;
  for (size_t i = 0; i < errors.noise.size(); ++i) {
    all.push_back(static_cast<uint32_t>(i));
    out.scenes.push_back(
        equal_samples(errors.predictor[i], errors.path_traced[i], errors.noise[i]));
    if (!std::isnan(out.scenes.back())) known.push_back(out.scenes.back());
  }
  out.all = errors.over(all);
  out.median = median_of(known);
  out.interval =
      bootstrap.interval([&](std::span<const uint32_t> scenes) { return errors.over(scenes); });
  return out;
}

}  // namespace

double equal_samples(double mse, double path_traced_mse, double noise) {
  const double variance = path_traced_mse - noise, error = mse - noise;
  if (!(variance > 0) || std::isnan(error)) return kMissing;
  return error > 0 ? kPathsStored * variance / error : std::numeric_limits<double>::infinity();
}

Score derived_path_tracing(const Score& at_64, const ReferenceNoise& points,
                           const ReferenceNoise& views, double paths) {
  Score out;
  const auto& [mse, psnr, relmse, logrel] = at_64.points;
  out.points = {at_paths(mse, points.mse, paths), 0, at_paths(relmse, points.relmse, paths),
                kMissing};
  out.points[1] = derived_psnr(psnr, mse, out.points[0]);
  const double view_mse = at_64.views[0], view_relmse = at_64.views[3];
  out.views = {at_paths(view_mse, views.mse, paths),       0,        kMissing,
               at_paths(view_relmse, views.relmse, paths), kMissing, kMissing};
  out.views[1] = derived_psnr(at_64.views[1], view_mse, out.views[0]);
  return out;
}

std::vector<PredictorSamples> all_equal_samples(const std::vector<SceneErrors>& scenes,
                                                const Bootstrap& bootstrap) {
  std::vector<Scores> scores;
  for (const SceneErrors& scene : scenes) scores.push_back(scene.scores);
  const Scores common = mean_scores(scores);
  std::vector<PredictorSamples> out;
  if (!find_score(common, kPathTraced)) return out;
  for (const auto& entry : common) {
    Errors points, views;
    for (const SceneErrors& scene : scenes) {
      const Score& own = *find_score(scene.scores, entry.first);
      const Score& path_traced = *find_score(scene.scores, kPathTraced);
      points.predictor.push_back(own.points[kMse]);
      points.path_traced.push_back(path_traced.points[kMse]);
      points.noise.push_back(scene.points_noise);
      views.predictor.push_back(own.views[kMse]);
      views.path_traced.push_back(path_traced.views[kMse]);
      views.noise.push_back(scene.views_noise);
    }
    out.push_back({entry.first, summarize(points, bootstrap), summarize(views, bootstrap)});
  }
  return out;
}

}  // namespace lte::infer
