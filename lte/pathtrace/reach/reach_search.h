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
inline constexpr int kReachRounds = 3;

/// reached(), which checks its arguments, with what is known from before.
std::vector<uint8_t> search_for_light(const Bvh& bvh, std::span<const Vec3> positions,
                                      std::span<const Vec3> normals, Sides sides,
                                      const ReachOptions& options, const ReachRecall& recall);

}  // namespace lte::pathtrace
