// How many points describe a scene to a network: one rule for all tools and the C interface.
#pragma once

#include <cstdint>

#include "lte/pathtrace/bvh.h"

namespace lte::embed {

/// Who reads what a network answers.
enum class Reader {
  Points,  ///< points themselves: a caller without rays
  Rays,    ///< rays that gather its light from the records of a cache
};

/// How finely the surface that light reaches is made, whatever its size: its area over the square
/// of the distance that one sees from it. That distance is the median over points, each of which
/// has the harmonic mean of what it sees from its more open side. A closed box without furniture
/// has about 50, a furnished room some hundreds, and several rooms as much as their sum.
///
/// By 256 points and 32 rays from each: known to a fifth, and always the same of a scene.
double surface_detail(const pathtrace::Bvh& bvh);

/// M for a scene: that of the model's training, or half of it where there is little detail. Rays,
/// which carry the light of records on, need an eighth of it, in rich scenes a fourth. It is 1,024
/// and 16 for each luminaire at least, as long as that is no more than in training.
/// @param trained  M of the model's training
int64_t scene_point_count(const pathtrace::Bvh& bvh, int64_t trained, Reader reader);

}  // namespace lte::embed
