// Surface points in a CSV file, and columns of results beside them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/math.h"

namespace lte::scene {

struct PointTable {
  std::vector<std::string> lines;  ///< as read, one a point; the output repeats them
  std::vector<Vec3> position, normal;

  size_t size() const { return position.size(); }
};

/// Reads `px,py,pz,nx,ny,nz` in world space and brings normals to unit length.
/// @throws lte::Error naming file, line and column of a number that is missing or not finite, or of
///         a zero normal.
PointTable read_point_table(const std::filesystem::path& path);

/// What stands beside the points: a name of each column, and a row of numbers a point.
struct PointColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;  ///< [points][names]
};

/// Writes the input columns and the others, floats with 9 digits. Atomic.
void write_point_table(const std::filesystem::path& path, const PointTable& points,
                       const PointColumns& columns);

}  // namespace lte::scene
