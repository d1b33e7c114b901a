// Path-traced irradiance at points that a table lists, for checks by other programs.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/point_table.h"

namespace lte::pathtrace {

struct ProbeOptions {
  int64_t rays = 1024;  ///< paths a point, or their cap under a target
  int max_depth = 5;
  double target_error = 0;  ///< relative standard error of total irradiance; 0: `rays` a point
  uint64_t seed = 1;
  /// Told of points as they are done, or under a target of paths. May be empty.
  std::function<void(int64_t count)> done;
};

struct ProbeResult {
  std::vector<Rgb> total, direct, standard_error;
  std::vector<int64_t> rays;  ///< number behind each estimate
  int64_t missed = 0;         ///< number of points above the target when the cap was reached
};

/// Estimates irradiance at each point. With a target, a pilot decides how many fresh paths the
/// estimate is made of (lte/pathtrace/adaptive.h, ErrorScale::OwnTotal): to choose the count from
/// the same samples would bias it. Standard errors come from the spread of independently scrambled
/// point sets, so they include the gain of stratification.
/// @throws lte::Error if options are out of range.
ProbeResult probe(const Bvh& bvh, const Lights& lights, const scene::PointTable& points,
                  const ProbeOptions& options);

/// move_onto_surfaces() of a table's points. A line says so where that is more than rounding.
/// @param file  the table's, for that line
void settle_points(const Bvh& bvh, const std::string& file, scene::PointTable* points);

/// total_r,g,b, direct_r,g,b, stderr_r,g,b and rays.
scene::PointColumns probe_columns(const ProbeResult& result);

}  // namespace lte::pathtrace
