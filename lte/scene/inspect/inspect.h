// Faults of a scene's geometry, counted: what a user mends in a modeller.
#pragma once

#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Counts over all instances of the scene. A shell is a surface connected through its edges; it is
/// closed if two triangles, wound alike, meet at each of them.
struct GeometryFaults {
  bool inspected = true;  ///< false for scenes of more instanced triangles than kMaxInspected
  int64_t degenerate_triangles = 0;   ///< thinner than 1e-7 of their longest edge: without a normal
  int64_t duplicate_triangles = 0;    ///< beyond the first: same places, material and winding
  int64_t opposite_triangles = 0;     ///< beyond the first: same places and material, other winding
  int64_t conflicting_triangles = 0;  ///< beyond the first: same places, other material
  int64_t near_duplicate_vertices = 0;
  int64_t open_edges = 0;  ///< of one triangle alone: light may leak there
  double open_edge_length_m = 0;
  int64_t branching_edges = 0;  ///< of three triangles or more
  int64_t flipped_edges = 0;    ///< between two triangles that are wound against each other
  int64_t closed_shells = 0;    ///< without an open, branching or flipped edge
  int64_t inward_shells = 0;    ///< closed ones whose front is inside: rooms are, furniture is not
};

inline constexpr int64_t kMaxInspected = 64'000'000;

/// @param tolerance  distance of near-duplicate vertices, as a share of the scene's diagonal
GeometryFaults inspect(const Scene& scene, double tolerance = 1e-6);

}  // namespace lte::scene
