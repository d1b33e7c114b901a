#include "lte/pathtrace/probe.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/pathtrace/adaptive.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/placement/onto_surfaces.h"

namespace lte::pathtrace {
namespace {

constexpr int kPilotRays = 64;
constexpr size_t kBlock = 4096;  // points between two looks at the progress

/// Copies point i of `estimate` to point `at` of the result.
void store(const Irradiance& estimate, int64_t i, int64_t rays, size_t at, ProbeResult* result) {
  const Rgb& variance = estimate.variance_total[static_cast<size_t>(i)];
  result->total[at] = estimate.total(i);
  result->direct[at] = estimate.direct_sum(i);
  result->standard_error[at] = {std::sqrt(variance.x), std::sqrt(variance.y),
                                std::sqrt(variance.z)};
  result->rays[at] = rays;
}

void probe_fixed(const Bvh& bvh, const Lights& lights, const scene::PointTable& points,
                 const ProbeOptions& options, ProbeResult* result) {
  IrradianceOptions tracing;
  tracing.rays = static_cast<int>(options.rays);
  tracing.max_depth = options.max_depth;
  tracing.seed = hash_combine(options.seed, 2);
  const size_t N = points.position.size();
  for (size_t first = 0; first < N; first += kBlock) {
    const size_t count = std::min(kBlock, N - first);
    const auto block = estimate_irradiance(
        bvh, lights, std::span(points.position).subspan(first, count),
        std::span(points.normal).subspan(first, count), tracing, static_cast<int64_t>(first));
    for (size_t i = 0; i < count; ++i)
      store(block, static_cast<int64_t>(i), block.rays, first + i, result);
    if (options.done) options.done(static_cast<int64_t>(count));
  }
}

void probe_adaptive(const Bvh& bvh, const Lights& lights, const scene::PointTable& points,
                    const ProbeOptions& options, ProbeResult* result) {
  AdaptiveOptions tracing;
  tracing.scale = ErrorScale::OwnTotal;
  tracing.target_error = options.target_error;
  tracing.max_rays = static_cast<int>(std::max<int64_t>(2, options.rays));
  tracing.min_rays = std::min(kPilotRays, tracing.max_rays);
  tracing.max_depth = options.max_depth;
  tracing.seed = options.seed;
  const size_t N = points.position.size();
  const AdaptiveIrradiance estimate =
      estimate_adaptive(bvh, lights, points.position, points.normal, tracing, options.done);
  for (size_t i = 0; i < N; ++i)
    store(estimate.irradiance, static_cast<int64_t>(i), estimate.rays[i], i, result);
  result->missed = estimate.missed;
}

}  // namespace

ProbeResult probe(const Bvh& bvh, const Lights& lights, const scene::PointTable& points,
                  const ProbeOptions& options) {
  LTE_CHECK(options.rays >= 1 && options.rays <= 1 << 30, "--rays: expected 1 to ", 1 << 30,
            ", got ", options.rays);
  LTE_CHECK(options.max_depth >= 1 && options.max_depth <= 1000,
            "--max-depth: expected 1 to 1000, got ", options.max_depth);
  LTE_CHECK(options.target_error >= 0 && std::isfinite(options.target_error),
            "--target-error: expected a number that is not negative, got ", options.target_error);
  const size_t N = points.position.size();
  ProbeResult result;
  result.total.resize(N);
  result.direct.resize(N);
  result.standard_error.resize(N);
  result.rays.resize(N);
  if (options.target_error == 0) {
    probe_fixed(bvh, lights, points, options, &result);
  } else {
    probe_adaptive(bvh, lights, points, options, &result);
  }
  return result;
}

void settle_points(const Bvh& bvh, const std::string& file, scene::PointTable* points) {
  const int64_t moved = move_onto_surfaces(bvh, points->normal, &points->position);
  if (moved > 0)
    log_info(file, ": ", moved, " of ", points->size(),
             " points lay a little behind a surface and were moved onto it");
}

scene::PointColumns probe_columns(const ProbeResult& result) {
  scene::PointColumns columns;
  columns.names = {"total_r",  "total_g",  "total_b",  "direct_r", "direct_g",
                   "direct_b", "stderr_r", "stderr_g", "stderr_b", "rays"};
  for (size_t i = 0; i < result.total.size(); ++i) {
    std::vector<double> row;
    for (const Rgb& value : {result.total[i], result.direct[i], result.standard_error[i]})
      for (int c = 0; c < 3; ++c) row.push_back(double{value[c]});
    row.push_back(static_cast<double>(result.rays[i]));
    columns.rows.push_back(std::move(row));
  }
  return columns;
}

}  // namespace lte::pathtrace
