// Points of a scene and the light that paths find there: what an embedding is fitted to.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::train {

struct FitQueries {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<Rgb> indirect;  ///< W/m²
  int64_t rays = 0;           ///< paths of each

  int64_t size() const { return static_cast<int64_t>(position.size()); }
};

/// Points on surfaces that light reaches and that reflect some, in an order of chance: the first of
/// them are spread as all are.
/// @throws lte::Error if the scene has no such point
FitQueries draw_queries(const pathtrace::Bvh& bvh, int64_t count, uint64_t seed);

/// Fills in the light of the first points, block after block, until `stop` says so, and drops the
/// others. At least one block is traced.
/// @param stop  is told of the points that are done
void trace_queries(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, int rays,
                   uint64_t seed, FitQueries* queries,
                   const std::function<bool(int64_t done)>& stop);

}  // namespace lte::train
