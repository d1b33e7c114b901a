// Irradiance with as many paths a point as its error asks for, without bias.
//
// Stopping on an estimate's own samples biases it: light that comes in rare bright paths is missed
// together with the variance that would have asked for more. Here the number of paths of a point
// never depends on the samples that its estimate is made of.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/pathtrace/irradiance.h"

namespace lte::pathtrace {

/// What the standard error of a point is held against.
enum class ErrorScale {
  /// Indirect irradiance, against its mean over the points. A pilot of `min_rays` paths a point
  /// measures both; a point's count follows from the pilot of its neighbours alone, so its own
  /// pilot stays independent of it and enters the estimate, weighted by paths.
  MeanIndirect,
  /// Total irradiance, against that of the point itself. Its own pilot decides, and is then thrown
  /// away: the estimate is of fresh paths only.
  OwnTotal,
};

struct AdaptiveOptions {
  ErrorScale scale = ErrorScale::MeanIndirect;
  double target_error = 0.02;  ///< standard error by the scale, averaged over color channels
  int min_rays = 64;           ///< paths of the pilot
  int max_rays = 4096;         ///< paths behind an estimate, rounded up to whole strata
  int max_depth = 5;
  uint64_t seed = 0;
};

struct AdaptiveIrradiance {
  /// The estimates of all points. `variance` is theirs, from independent scramblings as ever;
  /// `rays` is the mean over points; `rays_traced` counts the pilot too.
  Irradiance irradiance;
  std::vector<int32_t> rays;  ///< [points]: paths behind each estimate
  int64_t paths = 0;          ///< in all, with pilots that were thrown away
  int64_t missed = 0;         ///< points above the target though they had `max_rays`
};

/// Told of paths as they are done, so that a caller can show progress.
using PathsDone = std::function<void(int64_t paths)>;

/// Neighbours are the nearest of similar normal in Morton order: a bad guess costs paths or
/// accuracy, never bias. A single point has none and gets `max_rays` under MeanIndirect. The result
/// does not depend on threads, but, unlike estimate_irradiance()'s, on the whole set of points.
/// @throws lte::Error if sizes differ, a value is not finite, or options are out of range.
AdaptiveIrradiance estimate_adaptive(const Bvh& bvh, const Lights& lights,
                                     std::span<const Vec3> positions, std::span<const Vec3> normals,
                                     const AdaptiveOptions& options, const PathsDone& done = {});

}  // namespace lte::pathtrace
