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
#include "lte/pathtrace/lights/lights.h"

namespace lte::experiments {

/// How fast one of Embree's entry points alone traces the rays of the path tracer.
struct BareRate {
  std::string entry_point;  ///< e.g. "rtcIntersect8"; shadow rays take its rtcOccluded twin
  /// Rays of a point by direction octant and Morton code; the sorting is not timed.
  bool sorted = false;
  double rays_per_s = 0;
  int64_t stopped = 0;  ///< rays that a surface stopped: the same for all entry points
};

struct TraceRates {
  /// Intersect and occluded calls of estimate_irradiance() by the processor time of a thread.
  double path_rays_per_s = 0;
  int64_t rays = 0;
  std::vector<BareRate> bare;  ///< the path tracer's own entry point first
};

/// Records the rays of estimate_irradiance() (28 bytes each: choose points and rays for memory),
/// then times it beside replays of these rays on as many threads through each of Embree's entry
/// points, in the path tracer's order and sorted. They take turns until each has run for `seconds`;
/// the best run of each counts.
TraceRates measure_trace_rates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const pathtrace::IrradianceOptions& options, double seconds = 1.0);

}  // namespace lte::experiments
