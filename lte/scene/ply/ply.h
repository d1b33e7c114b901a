// PLY, the Stanford polygon format: triangle meshes of scanners, modellers and pbrt's "plymesh".
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/import/scene_files.h"

namespace lte::scene::ply {

/// Attributes are empty or one a vertex.
struct PlyMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Vec2> uvs;
  std::vector<Rgb> colors;  ///< linear: 8-bit ones carried the sRGB curve, floats are as they came
  std::vector<std::array<uint32_t, 3>> triangles;  ///< in the winding of the file's faces
  int64_t faces = 0;                               ///< before triangulation
  int64_t dropped_faces = 0;                       ///< of fewer than three corners
};

/// Reads PLY 1.0, ASCII or binary of either byte order, plain or gzip. Quads and polygons become
/// triangles: fans where convex, else by ear clipping. Properties: x y z; nx ny nz; u v, s t,
/// texture_u texture_v, texture_s texture_t; red green blue, r g b, diffuse_red ...; faces'
/// vertex_indices or vertex_index. Anything else is skipped.
/// @throws lte::Error naming the file and the line (header, ASCII) or the element (binary):
/// missing, foreign, truncated, a count that the file cannot hold, an index past the end, a
/// position that is not finite, no faces.
PlyMesh read_ply(const SceneFilePtr& file, LoadBudget* budget);

}  // namespace lte::scene::ply
