// What points tell of a surface: in each cell of a grid that they lie in, a piece of a plane
// (surface elements as in Pfister et al. 2000, "Surfels"), and pieces between those that lie near
// each other in one plane, as points drawn at random leave cells of a wall without any.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/radiosity/grid_shape.h"

namespace lte::radiosity {

struct Surfel {
  Vec3 middle, normal;
  int32_t cell, axis;  ///< the axis that the normal is nearest to: one surfel a cell and axis
};

/// In the order of their cells.
/// @param normals  unit vectors, either way around, one a position
std::vector<Surfel> surfels_of(std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const GridShape& grid);

}  // namespace lte::radiosity
