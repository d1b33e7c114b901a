// Which corners of a scene's triangles meet: one numbering of places for all instances.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// A triangle of an instance, by the places of its corners in its drawn winding (a mirroring
/// instance turns it around).
struct PlacedTriangle {
  std::array<uint32_t, 3> place;
  int instance = 0;
  uint32_t triangle = 0;  ///< of the instance's mesh
};

/// Vertices nearer to each other than a tolerance share a place; nearness is passed on, so a chain
/// of near vertices is one place.
struct WorldTopology {
  std::vector<Vec3> places;               ///< world position of one vertex of each
  std::vector<uint32_t> place_of_vertex;  ///< of all instances, one after another
  std::vector<size_t> first_vertex;       ///< of each instance, in place_of_vertex
  std::vector<PlacedTriangle> triangles;  ///< in the order of instances
  int64_t near_duplicates = 0;  ///< positions that differ, but share a place with another one

  uint32_t place(int instance, uint32_t vertex) const {
    return place_of_vertex[first_vertex[static_cast<size_t>(instance)] + vertex];
  }
};

/// Numbers the places of a scene. Nearest neighbours come from FLANN's k-d tree of those vertices
/// that share a cell of a hashed grid.
/// @param tolerance  a share of the scene's diagonal; 0 for identical positions alone
WorldTopology build_topology(const Scene& scene, double tolerance);

}  // namespace lte::scene
