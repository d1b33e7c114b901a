// Loop's subdivision surfaces of triangle meshes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/math.h"

namespace lte::scene {

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Refines the mesh `levels` times and moves its vertices onto the limit surface: Loop's scheme
/// with Warren's weights (3/16 for valence 3, 3/(8n) else), boundaries as cubic B-splines (Hoppe et
/// al. 1994). Vertices that no triangle uses are dropped; the winding stays.
/// @param control  indices in range
/// @throws lte::Error that begins with `where` if an edge has more than two triangles, or a vertex
/// lies on more than one boundary.
TriangleMesh loop_subdivide(const TriangleMesh& control, int levels, const std::string& where);

}  // namespace lte::scene
