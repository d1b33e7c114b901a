// Wavefront OBJ: the geometry file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/import/ignored_features.h"
#include "lte/scene/import/scene_files.h"

namespace lte::scene::obj {

inline constexpr uint32_t kNoUv = 0xffffffff;

/// Corner of a triangle: indices into ObjFile::positions and ::uvs, or kNoUv.
struct Corner {
  uint32_t position = 0, uv = kNoUv;
};

/// The faces of one object in one material, wherever they stand in the file.
struct Part {
  std::string name;      ///< of `o`, else of `g`; empty if neither was given
  std::string material;  ///< of `usemtl`; empty if none was given
  std::vector<std::array<Corner, 3>> triangles;
};

struct ObjFile {
  std::vector<Vec3> positions;
  std::vector<Rgb> colors;             ///< linear; empty or one a position
  std::vector<Vec2> uvs;               ///< (0, 0) at the top left: the file's V is turned around
  std::vector<Part> parts;             ///< in order of their first face
  std::vector<std::string> libraries;  ///< of `mtllib`, as written
};

/// Reads an OBJ file. Polygons become triangles. Points, lines and free-form geometry are ignored.
/// @throws lte::Error naming file and line: a number that is none or not finite, an index that is
/// 0, not an integer or past the vertices before it, a face of fewer than three corners, more
/// triangles than the limits.
ObjFile read_obj(const SceneFile& file, const LoadLimits& limits, IgnoredFeatures* ignored);

}  // namespace lte::scene::obj
