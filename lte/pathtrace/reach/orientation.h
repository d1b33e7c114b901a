// Internal: which side of its surface a point stands on. The winding of a file says nothing of it:
// a room that is a plain cube has its normals outward.
#pragma once

#include <cstdint>
#include <span>

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

}  // namespace lte::pathtrace
