// Indirect irradiance at points by rays that read tables of light, with its standard error.
//
// A single table would be wrong in its own way at every point that reads it: its places and its
// light are drawn. So the rays of a point are shared out over several tables, each of places and
// light of its own. What they disagree by tells of all of that: of rays, places and estimates.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

struct GatheredProbeOptions {
  int rays = 256;     ///< a point; rounded up to a multiple of `tables`
  int tables = 4;     ///< at least 2
  int max_depth = 5;  ///< surface hits of paths that no table ends
  uint64_t seed = 0;
  std::function<void(int64_t points)> done;  ///< points done, each `tables` times; may be empty
};

struct GatheredProbe {
  std::vector<Rgb> indirect, standard_error;  ///< W/m², an entry a point
  int tables = 0;
  int64_t rays = 0;  ///< behind each
};

/// @param make_cache  the table of a number, from 0 on
/// @throws lte::Error as gi::gather_irradiance(), and without two tables
GatheredProbe gather_at(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const scene::PointTable& points, const GatheredProbeOptions& options,
                        const std::function<gi::IrradianceCache(int)>& make_cache);

}  // namespace lte::infer
