// The points and pixels of a baked scene at which predictors are compared, in the evaluation's
// units: indirect irradiance over the emission scalar.
#pragma once

#include <array>
#include <vector>

#include "infer/common/points.h"
#include "infer/eval/equal_samples.h"
#include "lte/data/scene_sample.h"

namespace lte::infer {

struct Site {
  QueryPoints queries;
  std::vector<Rgb> reference, direct;
  std::vector<Rgb> path_traced;  ///< empty if the data has none
  /// With data::kFewPaths paths; empty at points, and in views if the data has none.
  std::array<std::vector<Rgb>, data::kFewPaths.size()> path_traced_few;
  std::vector<float> variance;  ///< of the reference, averaged over color; over the scalar squared

  /// Zero for a site without points.
  ReferenceNoise noise() const;
};

/// The query points; borrows them.
Site point_site(const data::SceneSample& sample, double radiance);

/// The pixels of a view that show a surface, one after another.
struct ViewPixels {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  Site site;

  ViewPixels(const data::View& view, int64_t groups, double radiance);
  ViewPixels(const ViewPixels&) = delete;
  ViewPixels& operator=(const ViewPixels&) = delete;
};

/// Mean over the query points of the variance of a single path, over the emission scalar squared,
/// as far as the spread of the reference tells it: its variance times its paths.
double single_path_variance(const data::SceneSample& sample, double radiance);

}  // namespace lte::infer
