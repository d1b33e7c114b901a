// Polygons to triangles.
#include <cmath>
#include <utility>

#include "lte/scene/ply.h"

namespace lte::scene {
namespace {

struct Point2 {
  double x = 0, y = 0;
};

/// Twice the signed area of a triangle.
double doubled_area(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners in the plane across the largest axis of Newell's normal, counter-clockwise.
std::vector<Point2> project(const std::vector<Vec3>& positions,
                            const std::vector<uint32_t>& corners) {
  std::array<double, 3> normal{};
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &p = positions[corners[i]], &q = positions[corners[(i + 1) % corners.size()]];
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      normal[static_cast<size_t>(axis)] += (double{p[u]} - q[u]) * (double{p[v]} + q[v]);
    }
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(normal[static_cast<size_t>(i)]) > std::abs(normal[static_cast<size_t>(axis)]))
      axis = i;
  }
  const double sign = normal[static_cast<size_t>(axis)] < 0 ? -1 : 1;
  std::vector<Point2> out;
  out.reserve(corners.size());
  for (const uint32_t corner : corners) {
    const Vec3& p = positions[corner];
    out.push_back({sign * p[(axis + 1) % 3], p[(axis + 2) % 3]});
  }
  return out;
}

bool is_convex(const std::vector<Point2>& points) {
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t j = (i + 1) % points.size(), k = (i + 2) % points.size();
    if (doubled_area(points[i], points[j], points[k]) < 0) return false;
  }
  return true;
}

/// Whether the corner `ring[i]` can be cut off: it is convex, and no other corner lies in its
/// triangle.
bool is_ear(const std::vector<Point2>& points, const std::vector<size_t>& ring, size_t i) {
  const size_t n = ring.size();
  const size_t before = ring[(i + n - 1) % n], tip = ring[i], after = ring[(i + 1) % n];
  const Point2 &a = points[before], &b = points[tip], &c = points[after];
  if (!(doubled_area(a, b, c) > 0)) return false;
  for (const size_t other : ring) {
    if (other == before || other == tip || other == after) continue;
    const Point2& p = points[other];
    if (doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0)
      return false;
  }
  return true;
}

}  // namespace

void triangulate_polygon(const std::vector<Vec3>& positions, const std::vector<uint32_t>& corners,
                         std::vector<std::array<uint32_t, 3>>* out) {
  if (corners.size() == 3) {
    out->push_back({corners[0], corners[1], corners[2]});
    return;
  }
  const std::vector<Point2> points = project(positions, corners);
  if (is_convex(points)) {
    for (size_t i = 1; i + 1 < corners.size(); ++i)
      out->push_back({corners[0], corners[i], corners[i + 1]});
    return;
  }
  std::vector<size_t> ring(corners.size());
  for (size_t i = 0; i < ring.size(); ++i) ring[i] = i;
  while (ring.size() > 3) {
    // A polygon that crosses itself may have no ear left: the first corner goes then.
    size_t ear = 0;
    while (ear < ring.size() && !is_ear(points, ring, ear)) ++ear;
    if (ear == ring.size()) ear = 0;
    const size_t n = ring.size();
    out->push_back(
        {corners[ring[(ear + n - 1) % n]], corners[ring[ear]], corners[ring[(ear + 1) % n]]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  out->push_back({corners[ring[0]], corners[ring[1]], corners[ring[2]]});
}

}  // namespace lte::scene
