// Which points light can reach: closed interiors of furniture, floors under carpets and the like
// cost as much as any other point and have nothing to say.
//
// A point is kept if
//   1. any of up to 20 paths from it carries light (4, and 16 more where all were dark),
//      each of at most `max_depth` hits, with a light sample at every vertex that draws all light
//      groups alike, so that a faint lamp in a closed room is found beside bright ones outside; or
//   2. a vertex of those paths sees a point nearby that is kept: then there is a way for light to
//      reach it, if perhaps a longer one.
//
// After each round of paths the second spreads from kept points until nothing changes, and the next
// round goes out from what is dark still. Dark points whose paths lead to one another lie in one
// pocket. Where 256 paths from a pocket have found nothing no more are traced there.
//
// Both conditions keep only what is truly connected to a light; the rest is pruned. That errs where
// light comes in through an opening that none of the paths from a pocket finds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/scene/sampler.h"

namespace lte::pathtrace {

struct ReachOptions {
  int max_depth = 5;
  uint64_t seed = 0;
  std::vector<int> without = {};  ///< light groups that do not count as light
};

/// Which side of its surface makes a point worth keeping.
enum class Sides {
  Front,   ///< the one its normal points to
  Either,  ///< surfaces reflect on both
};

/// @return  [points]: 1 to keep, 0 for what light does not reach. All 1 in a scene without light.
/// @throws lte::Error if sizes differ, a value is not finite, or an option is out of range.
/// @note The same for any number of threads.
std::vector<uint8_t> reached(const Bvh& bvh, std::span<const Vec3> positions,
                             std::span<const Vec3> normals, Sides sides,
                             const ReachOptions& options);

/// Points that were drawn and left out.
struct PruneCounts {
  int64_t drawn = 0, pruned = 0;
};

/// What points are drawn for.
enum class Purpose {
  Queries,  ///< light is wanted there
  Scene,    ///< they describe a scene: luminaires among them stay whatever light reaches them
};

/// scene::sample_surface() over the surfaces that light reaches, on either side: more points are
/// drawn, so that `count` are left. A point's normal faces the side that light reaches, whatever
/// the winding of the surface; where that is both, the more enclosed one, or either by chance
/// (orientation.h).
///
/// Lights are never pruned, but for faces of two-sided luminaires that shine at nothing
/// (orientation.h). Those that are no surface have their points as sample_surface() gives them. So
/// have luminaires for Purpose::Scene, unless theirs would be more than half: then each
/// keeps fewer, but one at least. What is dropped to bring the number down to `count` are other
/// surface points.
///
/// The `area` of other points sums to the area that light reaches. For Purpose::Scene that of a
/// luminaire's points sums to its own, of all faces that shine at something, and where these are
/// fewer than were drawn to its power over their radiance: the power of each light is that of the
/// scene.
/// @throws lte::Error as sample_surface()
/// @note Where less than an eighth of the surface is reached, fewer than `count` come back; where
/// none is, or nothing shines, `count` unpruned ones.
scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Purpose purpose,
                                             const ReachOptions& options, PruneCounts* counts);

/// scene::sample_surface() with normals that face the side that light reaches, as above, of all the
/// surface: for networks that know points in the dark too. Faces of luminaires that shine at
/// nothing have no points, so fewer than `count` may come back.
scene::SurfaceSamples sample_turned_surface(const Bvh& bvh, int64_t count,
                                            const scene::SamplerOptions& sampler,
                                            const ReachOptions& options);

}  // namespace lte::pathtrace
