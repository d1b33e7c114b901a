// The points and pixels of a baked scene at which predictors are compared, in the evaluation's
// units: indirect irradiance over the emission scalar.
#pragma once

#include <array>
#include <vector>

#include "infer/eval/measure/equal_samples.h"
#include "lte/data/scene_sample.h"
#include "lte/runtime/points.h"

namespace lte::infer {

/// Points with what is known of the light there.
struct EvalPoints {
  runtime::QueryPoints queries;
  std::vector<Rgb> reference, direct;
  std::vector<Rgb> path_traced;  ///< with 64 paths; empty if the data has none
  /// With data::kFewPaths paths; empty at query points, and in views if the data has none.
  std::array<std::vector<Rgb>, data::kFewPaths.size()> path_traced_few;
  /// Variance of the reference, averaged over color, over the emission scalar squared.
  std::vector<float> variance;

  /// What the variance adds to the errors; zero without points.
  ReferenceNoise noise() const;
};

/// The query points of a sample, which they borrow.
EvalPoints query_eval_points(const data::SceneSample& sample, double radiance);

/// The pixels of a view that show a surface, one after another.
struct ViewPixels {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  EvalPoints points;  ///< borrows the three above

  ViewPixels(const data::View& view, int64_t groups, double radiance);
  ViewPixels(const ViewPixels&) = delete;
  ViewPixels& operator=(const ViewPixels&) = delete;
};

/// The variance of a single path, averaged over the query points, over the emission scalar squared.
/// It is estimated from the spread of the reference: the reference's variance times its paths.
double single_path_variance(const data::SceneSample& sample, double radiance);

}  // namespace lte::infer
