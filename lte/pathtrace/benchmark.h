// How fast paths are traced, beside the bare Embree calls on the very same rays: what the path
// tracer itself costs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights.h"

namespace lte::pathtrace {

/// The rays of the path tracer through one of Embree's entry points and nothing else.
struct BareRate {
  std::string entry_point;  ///< e.g. "rtcIntersect8"; shadow rays through its rtcOccluded twin
  bool sorted = false;  ///< rays of a point by direction octant and Morton code; sorting not timed
  double rays_per_s = 0;
};

struct TraceRates {
  /// Intersect and occluded calls of estimate_irradiance(), by processor time a thread.
  double path_rays_per_s = 0;
  int64_t rays = 0;
  std::vector<BareRate> bare;  ///< the path tracer's own entry point first

  double best_bare_rays_per_s() const;
};

/// Times estimate_irradiance(), then records its rays (28 bytes each: choose points and rays for
/// memory) and replays them on as many threads through each of Embree's entry points, in the path
/// tracer's order and sorted. Path tracer and replays take turns until each has run for `seconds`;
/// the best run of each counts.
TraceRates measure_trace_rates(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, double seconds = 1.0);

/// Error of indirect irradiance before and after an improvement, at the same number of paths.
struct ErrorGain {
  int64_t rays = 0;  ///< paths a point
  /// Root mean square over points and channels, relative to the mean.
  double rmse_before = 0, rmse_after = 0;
  double rays_ratio =
      0;  ///< ratio of the squares: paths before for the error after, by paths after
};

/// How errors are measured: with each number of paths, `repeats` times with other seeds, against a
/// reference of `reference_rays`, whose own variance is subtracted.
struct GainOptions {
  std::vector<int> rays{64, 256, 1024};
  int reference_rays = 1 << 14, repeats = 12, max_depth = 5;
};

/// Independent random numbers against stratified ones.
std::vector<ErrorGain> measure_stratification(const Bvh& bvh, std::span<const Vec3> positions,
                                              std::span<const Vec3> normals,
                                              const GainOptions& options);

/// Lights drawn by power against the light tree.
std::vector<ErrorGain> measure_light_tree(const Bvh& bvh, std::span<const Vec3> positions,
                                          std::span<const Vec3> normals,
                                          const GainOptions& options);

}  // namespace lte::pathtrace
