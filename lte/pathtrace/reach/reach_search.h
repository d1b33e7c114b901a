// Internal: the search for points that light reaches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/reach/reach_memory.h"

namespace lte::pathtrace {

/// Rounds of condition 1 (reach.h).
inline constexpr int kReachRounds = 2;

/// Bits of a point's sides where paths have found light.
inline constexpr uint8_t kFrontLit = 1, kBackLit = 2;

/// reached(), which checks its arguments, with what is known from before.
/// @return  [points] kFrontLit and kBackLit, 0 for a point that light does not reach. For
///          Sides::Either both sides have as many paths until light is found on one. In a scene
///          without light, kFrontLit.
std::vector<uint8_t> search_for_light(const Bvh& bvh, std::span<const Vec3> positions,
                                      std::span<const Vec3> normals, Sides sides,
                                      const ReachOptions& options, const ReachRecall& recall);

}  // namespace lte::pathtrace
