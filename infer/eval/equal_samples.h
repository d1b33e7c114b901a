// How many paths a point or pixel an error is worth.
//
// The variance of path tracing falls as 1/n with its paths n, so its MSE against a reference of
// noise r is a/n + r. The data hold one path-traced estimate of 64 paths, independent of the
// reference, whose MSE gives a; and r, the mean variance of the reference. docs/metrics.md tells
// how far this holds.
#pragma once

#include <string>
#include <vector>

#include "infer/eval/bootstrap.h"
#include "infer/eval/scores.h"

namespace lte::infer {

inline constexpr const char* kPathTraced = "path_tracing_64";
inline constexpr double kPathsStored = 64;

/// What the reference's own noise adds to a mean squared error and to a relative one; over the
/// emission scalar squared.
struct ReferenceNoise {
  double mse = 0, relmse = 0;
};

/// n of a/n + r = mse. Infinite if `mse` is below r; NaN where nothing is known, or path tracing
/// shows no variance.
double equal_samples(double mse, double path_traced_mse, double noise);

/// The score of `paths` paths from that of 64, where none are traced. Figures that do not follow
/// from a variance are NaN: logrel, SSIM, FLIP.
Score derived_path_tracing(const Score& at_64, const ReferenceNoise& points,
                           const ReferenceNoise& views, double paths);

/// Everything about one predictor; `all` is of the mean errors of all scenes, `median` of the
/// scenes' numbers.
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

/// Of every predictor that every scene has; empty if some scene lacks path_tracing_64.
std::vector<PredictorSamples> all_equal_samples(const std::vector<SceneErrors>& scenes,
                                                const Bootstrap& bootstrap);

}  // namespace lte::infer
