#include "experiments/attention/closest_point.h"

#include <cmath>

#include "lte/base/check.h"

namespace lte::experiments {
namespace {

/// Barycentrics of the point of a triangle nearest to p: 1 − u − v, u, v of its corners.
struct Barycentrics {
  float u = 0, v = 0;
};

float clamp01(float x) { return std::fmin(std::fmax(x, 0.0f), 1.0f); }

/// Ericson, Real-Time Collision Detection (2005), section 5.1.5: by the region that p projects to.
Barycentrics nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp),
              d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {clamp01(d1 / (d1 - d3)), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, clamp01(d2 / (d2 - d6))};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const float w = clamp01((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    return {1 - w, w};
  }
  const float scale = 1 / (va + vb + vc);
  return {vb * scale, vc * scale};
}

struct Found {
  int instance = scene::kNone;
  uint32_t triangle = 0;
  Barycentrics at;
  float square = INFINITY;
};

void look_at(const scene::Scene& scene, int index, const Vec3& place, Found* found) {
  const scene::Instance& instance = scene.instances[static_cast<size_t>(index)];
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  std::vector<Vec3> world;
  world.reserve(mesh.positions.size());
  for (const Vec3& position : mesh.positions) world.push_back(instance.to_world.point(position));
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3 &a = world[i], &b = world[j], &c = world[k];
    if (!(length(cross(b - a, c - a)) > 0)) continue;
    const Barycentrics at = nearest_in_triangle(place, a, b, c);
    const Vec3 offset = a * (1 - at.u - at.v) + b * at.u + c * at.v - place;
    const float square = dot(offset, offset);
    if (square < found->square) *found = {index, static_cast<uint32_t>(t), at, square};
  }
}

}  // namespace

ClosestPoint closest_point(const scene::Scene& scene, const Vec3& place) {
  LTE_CHECK(is_finite(place), "a place must be finite");
  Found found;
  for (size_t i = 0; i < scene.instances.size(); ++i)
    look_at(scene, static_cast<int>(i), place, &found);
  LTE_CHECK(found.instance != scene::kNone, "the scene has no triangle with an area");
  ClosestPoint out;
  out.surface =
      scene::evaluate_surface(scene, found.instance, found.triangle, found.at.u, found.at.v, 0);
  out.distance = std::sqrt(found.square);
  if (dot(place - out.surface.position, out.surface.normal) < 0)
    out.surface.normal = -out.surface.normal;
  return out;
}

}  // namespace lte::experiments
