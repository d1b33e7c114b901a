// How many paths a point or pixel an error is worth.
//
// The variance of path tracing falls as 1/n with its paths n, so its MSE against a reference of
// noise r is a/n + r. The data hold one path-traced estimate of 64 paths that is independent of the
// reference. Its MSE gives a, and the mean variance of the reference is r. docs/metrics.md says how
// well this holds.
#pragma once

#include <string>
#include <vector>

#include "infer/eval/measure/bootstrap.h"
#include "infer/eval/measure/scores.h"
#include "infer/picture/picture_score.h"

namespace lte::infer {

inline constexpr const char* kPathTraced = "path_tracing_64";
inline constexpr double kPathsStored = 64;

/// Solves a/n + r = mse for n. Infinite if `mse` is below r; NaN where a figure is missing or path
/// tracing shows no variance.
double equal_samples(double mse, double path_traced_mse, double noise);

/// Derives the score of `paths` paths from that of 64; the noises are over the emission scalar
/// squared. Figures that do not follow from a variance are NaN: logrel, SSIM, FLIP.
Score derived_path_tracing(const Score& at_64, const ReferenceNoise& points,
                           const ReferenceNoise& views, double paths);

/// What the errors of one predictor are worth. `all` is computed from the mean errors of all
/// scenes, `median` is the median of the scenes' numbers.
struct EqualSamples {
  double all, median;
  Interval interval;  ///< of `all`
  std::vector<double> scenes;
};
struct PredictorSamples {
  std::string name;
  EqualSamples points, views;
};

struct SceneErrors {
  const Scores& scores;
  double points_noise, views_noise;
};

/// Computes them for every predictor that every scene has. Empty if some scene lacks
/// path_tracing_64.
std::vector<PredictorSamples> all_equal_samples(const std::vector<SceneErrors>& scenes,
                                                const Bootstrap& bootstrap);

}  // namespace lte::infer
