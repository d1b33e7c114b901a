// Internal: which side of its surface a point stands on. The winding of a file says nothing of it:
// a room that is a plain cube has its normals outward.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/scene/sampler.h"

namespace lte::pathtrace {

/// Turns the normals of points to the side that light reaches. Where it reaches both, to the one
/// that is more enclosed: an outer wall in the sun is a wall of the room behind it. Where both are
/// alike, as with a partition between two rooms, half of the points, by chance, stand on either.
/// Points of luminaires keep the side that they emit from.
/// @param lit  a point: bits kFrontLit and kBackLit (reach_search.h); 0 leaves the normal
/// @note The result depends neither on the winding of the surfaces nor on threads.
void turn_to_light(const Bvh& bvh, std::span<const uint8_t> lit, uint64_t seed,
                   scene::SurfaceSamples* samples);

/// Points of which light has been found on one side alone, while the other is more enclosed: worth
/// a longer look, as a wall in the sun is a wall of the room behind it.
/// @param lit  a point: bits kFrontLit and kBackLit
/// @return  their numbers, in order
std::vector<size_t> lit_from_outside(const Bvh& bvh, std::span<const uint8_t> lit, uint64_t seed,
                                     const scene::SurfaceSamples& samples);

/// Which points of luminaires that emit from both sides shine at nothing: no ray from their face
/// meets a surface of anything else, where other faces of the luminaire do. So is the inside of a
/// closed globe, and the upper face of a lamp under the open sky.
/// @return  [count] 1 for those of the first `count` samples
std::vector<uint8_t> shines_at_nothing(const Bvh& bvh, const scene::SurfaceSamples& samples,
                                       int64_t count, uint64_t seed);

}  // namespace lte::pathtrace
