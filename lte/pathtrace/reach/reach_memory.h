// What a search for the surfaces that light reaches has found, for the next one: most of its time
// goes into points in the dark, and few of them change when an object moves.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/reach/light_finder.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/scene/sampler.h"

namespace lte::pathtrace {

/// The points of each search of one sample_reached_surface() that stayed dark, and where their
/// paths went. Some hundred bytes a dark point.
struct ReachMemory {
  struct DarkPoint {
    Vec3 position;              ///< world
    std::vector<Place> places;  ///< its front and, for Sides::Either, its back
  };
  struct Search {
    Vec3 frame;
    std::vector<int32_t> dark_of_point;  ///< index into `dark`, −1 for a point that paths reached
    std::vector<DarkPoint> dark;
  };
  std::vector<Search> searches;
};

/// What is known of a scene from before a change, and what the search may take.
struct ReachRecall {
  const ReachMemory* before = nullptr;  ///< null: nothing
  /// Where surfaces have been taken away or put since. Light and colors are the same.
  std::span<const Bounds> changed = {};
  ReachMemory* now = nullptr;  ///< gets what this search finds; may be null
  /// Of condition 1 (reach.h): 1 or 2, for 4 or 20 paths at most. Fewer take some points for
  /// dark that little light reaches.
  int rounds = 2;
  /// Called now and then by any thread; what it throws ends the search. May be null.
  std::function<void()> check = {};
};

/// sample_reached_surface() that takes a point for dark if it was so before and no path from it had
/// come to a place that has changed. Points at the same number count as the same if they lie within
/// a thousandth of the scene's extent.
/// @note A change that none of 20 paths from a point met, and that yet lets light through to it, is
///       missed.
scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Purpose purpose,
                                             const ReachOptions& options, const ReachRecall& recall,
                                             PruneCounts* counts);

}  // namespace lte::pathtrace
