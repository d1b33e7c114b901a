// World-space triangles: what evaluation and sampling share.
#pragma once

#include <cmath>
#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::scene {

struct WorldTriangle {
  Vec3 p0, p1, p2;
};

inline WorldTriangle world_triangle(const Mesh& mesh, const Affine& to_world, uint32_t triangle) {
  const std::array<uint32_t, 3>& corner = mesh.triangles[triangle];
  return {to_world.point(mesh.positions[corner[0]]), to_world.point(mesh.positions[corner[1]]),
          to_world.point(mesh.positions[corner[2]])};
}

/// The cross product of two edges, in double: float would underflow to 0 for edges below 1e-19 m
/// and overflow above 1e19.
struct AreaVector {
  double x, y, z;
  double norm() const { return std::sqrt(x * x + y * y + z * z); }
};

inline AreaVector area_vector(const WorldTriangle& t) {
  const double ax = double{t.p1.x} - t.p0.x, ay = double{t.p1.y} - t.p0.y,
               az = double{t.p1.z} - t.p0.z;
  const double bx = double{t.p2.x} - t.p0.x, by = double{t.p2.y} - t.p0.y,
               bz = double{t.p2.z} - t.p0.z;
  return {ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx};
}

/// Area in m².
inline double area(const WorldTriangle& triangle) { return 0.5 * area_vector(triangle).norm(); }

}  // namespace lte::scene
