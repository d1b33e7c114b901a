// What is known of each query point before training: how noisy its reference is, and how fast it
// changes around it.
#pragma once

#include <vector>

#include "lte/base/math.h"
#include "lte/data/scene_sample.h"

namespace lte::train {

/// Of each query, [N], with all luminaires at unit gain.
struct QueryScores {
  std::vector<float> noise;  ///< variance of the reference's indirect part over its square
  std::vector<float> slope;  ///< change of log irradiance per metre
};

/// @return [N]; 0 where there is no indirect light
std::vector<float> query_noise(const data::SceneSample& sample);

/// The steepest change from each query to its neighbours along a space-filling curve, as far as
/// they face the same way: a rough guess, good enough to say where more queries pay.
/// @param target  [G, N]
/// @return [N], 0 for a query without such a neighbour
std::vector<float> query_slope(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                               const std::vector<Rgb>& target);

}  // namespace lte::train
