// Irradiance at points by path tracing: the ground truth of training and the reference of every
// error figure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::pathtrace {

struct IrradianceOptions {
  /// Cosine-weighted paths a point, rounded up to whole strata (see Irradiance::rays).
  int rays = 1024;
  /// Surface hits after leaving the point; 1 is direct light.
  int max_depth = 5;
  uint64_t seed = 0;
  /// First bounce from which Russian roulette may end a path. Unbiased whatever its value.
  int roulette_depth = 3;
  /// Only direct light (depth 1) is wanted. Its values are those that whole paths give, which are
  /// left out.
  bool direct_only = false;
  /// Without it, one ray stays one ray, which has no spread, and Irradiance::variance and
  /// variance_total stay empty; more rays give the same values.
  bool variance = true;
  /// Light by group; without it the sum alone, as one group: memory and time for a scene of
  /// thousands of luminaires.
  bool by_group = true;
  /// Irradiance::group_variance is wanted too. It needs `variance` and `by_group`.
  bool group_variance = false;
  bool last_bounce = false;             ///< Irradiance::last is wanted too
  Sampling sampling = Sampling::Sobol;  ///< Random: to measure what stratification saves
};

/// Irradiance E = ∫ L cosθ dω by light group at unit gain, linear Rec.709, W/m².
///
/// The paths of a point are cut into batches, each a point set of its own scrambling: 8 of them, 16
/// from 4,096 rays on, as many as there are rays below 8. Batches are independent, so the spread of
/// their means is an unbiased estimate of the variance, stratification included. From so few it is
/// itself known to 53 % (8 batches) or 37 % (16): average it over points before relying on it.
struct Irradiance {
  int64_t groups = 0, points = 0;
  std::vector<Rgb> direct;    ///< [groups, points]: depth 1
  std::vector<Rgb> indirect;  ///< [groups, points]: depths 2 to max_depth
  std::vector<Rgb> last;      ///< [groups, points]: of that max_depth alone; empty unless asked for
  /// [points]: variance of the *mean* of indirect irradiance summed over groups, averaged over
  /// color channels.
  std::vector<float> variance;
  /// [groups, points]: variance of the mean of indirect irradiance by light group, of the mean over
  /// the color channels. Empty unless asked for.
  std::vector<float> group_variance;
  /// [points]: the same of total irradiance, by color channel.
  std::vector<Rgb> variance_total;
  /// Paths a point: multiples of 8 above 8, of 64 above 64; at least 2 if variance is asked for.
  int64_t rays = 0;
  int64_t rays_traced = 0;  ///< intersect and occluded calls in all

  Rgb total(int64_t point) const;  ///< sum over groups of direct + indirect
  Rgb direct_sum(int64_t point) const;
  Rgb indirect_sum(int64_t point) const;
};

/// Estimates irradiance over the hemisphere around `normals[i]` at `positions[i]`, in parallel.
/// Point i draws from stream (seed, first_index + i), so the result depends neither on threads nor
/// on how a set is cut into calls. Next-event estimation and hemisphere sampling are combined by
/// the balance heuristic. `normals` must be unit vectors.
/// @throws lte::Error if sizes differ, a value is not finite, or options are out of range.
Irradiance estimate_irradiance(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, int64_t first_index = 0);

}  // namespace lte::pathtrace
