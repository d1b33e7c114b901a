// Points where light is wanted, and their path-traced references, kept from one run to the next.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "experiments/gathered_base/point_errors.h"
#include "lte/render/integrator.h"

namespace lte::experiments {

struct Queries {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  PointReferences references;
};

struct QueryOptions {
  int64_t points = 1000;
  int paths = 512;  ///< a point, of each of both references
  int max_depth = 5;
  uint64_t seed = 0;
};

/// Draws points by area where light reaches, and traces their references, or reads these from a
/// file that an earlier call has written.
/// @param file  empty: none
/// @throws lte::Error naming the file if it is of other points
Queries make_queries(const render::TracedScene& scene, const QueryOptions& options,
                     const std::filesystem::path& file);

}  // namespace lte::experiments
