// Internal: paths from many places at once, each of which ends where its place has found light.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"

namespace lte::pathtrace {

/// Where a path went on from: just off a surface, relative to the frame, on this side of it (unit).
struct PathVertex {
  Vec3 position, side;
};

/// One side of a point, and what paths from there have met.
struct Place {
  Vec3 origin, side;   ///< as PathVertex
  uint32_t point = 0;  ///< its random numbers are those of this stream
  bool lit = false;    ///< a path found light, or a way to another lit place
  int64_t paths = 0;   ///< that were traced and found none
  Bounds bounds;       ///< of all their vertices
  /// Of the paths of the last round: some of each depth, the place itself first. Empty if they
  /// found light.
  std::vector<PathVertex> vertices;
};

/// Traces so many paths from each place that `numbers` lists, with a light sample at every vertex,
/// and notes what they have found.
/// @param paths  of one place: a power of two, at most kBlock
/// @param check  called by any thread now and then; what it throws ends the search; may be null
void find_light(const Bvh& bvh, const Lights& lights, const ReachOptions& options, int paths,
                std::span<const uint32_t> numbers, const std::function<void()>& check,
                std::vector<Place>* places);

}  // namespace lte::pathtrace
