// Points given with too few digits, brought back to the surfaces that they were meant to lie on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"

namespace lte::pathtrace {

/// Moves each point that lies behind the nearest surface facing along its normal onto it, if it is
/// within 1e-4 of the extent of the scene: rays from behind a surface would find darkness. A point
/// on a surface, or before it, stays. Winding does not count.
/// @param normals  unit, one a position
/// @return  how many have moved farther than rounding of exact positions explains
/// @throws lte::Error if sizes differ
int64_t move_onto_surfaces(const Bvh& bvh, std::span<const Vec3> normals,
                           std::vector<Vec3>* positions);

}  // namespace lte::pathtrace
