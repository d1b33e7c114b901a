// Spheres, cylinders and disks as meshes.
#include <algorithm>
#include <cmath>

#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {
namespace {

/// Segments of an arc of `angle` radians at kChordError.
int segments(double angle) {
  const double step = 2 * std::acos(1 - kChordError);
  return std::max(1, static_cast<int>(std::ceil(std::abs(angle) / step - 1e-9)));
}

double positive(const Params& params, const std::string& name, double fallback) {
  const double value = params.number(name, fallback);
  if (!(value > 0))
    fail(params.at(), params.what(), ": ", quote(name), " must be positive, got ", value);
  return value;
}

/// "phimax", in radians.
double sweep(const Params& params) {
  const double degrees = std::clamp(params.number("phimax", 360), 0.0, 360.0);
  if (!(degrees > 0)) fail(params.at(), params.what(), ": \"phimax\" must be positive");
  return degrees * (M_PI / 180);
}

/// One row of a surface of revolution about z: the v of its texture coordinates, radius, height.
struct Ring {
  double v, radius, z;
};

/// Rows from the first to the last; a full turn shares no vertices at its seam, where u jumps. The
/// front is to the right of the way from the first row to the last, seen against the turn: outside
/// where z grows.
Mesh revolve(const std::vector<Ring>& rings, double angle) {
  Mesh mesh;
  const int turns = segments(angle);
  const bool closed = angle >= 2 * M_PI - 1e-9;
  for (const Ring& ring : rings) {
    for (int i = 0; i <= turns; ++i) {
      const double phi = closed && i == turns ? 0 : angle * i / turns;
      mesh.positions.push_back({static_cast<float>(ring.radius * std::cos(phi)),
                                static_cast<float>(ring.radius * std::sin(phi)),
                                static_cast<float>(ring.z)});
      mesh.uvs[0].push_back(
          {static_cast<float>(i) / static_cast<float>(turns), static_cast<float>(ring.v)});
    }
  }
  const auto row = static_cast<uint32_t>(turns + 1);
  for (uint32_t j = 0; j + 1 < rings.size(); ++j) {
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t a = j * row + i, b = a + 1, c = a + row, d = c + 1;
      // At a pole one of the two has no area.
      if (rings[j].radius > 0) mesh.triangles.push_back({a, b, d});
      if (rings[j + 1].radius > 0) mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

}  // namespace

Mesh make_sphere(const Params& params) {
  const double radius = positive(params, "radius", 1);
  double low = std::clamp(params.number("zmin", -radius), -radius, radius);
  double high = std::clamp(params.number("zmax", radius), -radius, radius);
  if (low > high) std::swap(low, high);
  if (!(low < high))
    fail(params.at(), params.what(), ": \"zmin\" and \"zmax\" leave nothing of it");
  const double first = std::acos(low / radius), last = std::acos(high / radius);
  const int rows = std::max(2, segments(last - first));
  std::vector<Ring> rings;
  for (int j = 0; j <= rows; ++j) {
    const double v = static_cast<double>(j) / rows, theta = first + (last - first) * v;
    const bool pole = (j == 0 && low == -radius) || (j == rows && high == radius);
    rings.push_back({v, pole ? 0 : radius * std::sin(theta), radius * std::cos(theta)});
  }
  return revolve(rings, sweep(params));
}

Mesh make_cylinder(const Params& params) {
  const double radius = positive(params, "radius", 1);
  double low = params.number("zmin", -1), high = params.number("zmax", 1);
  if (low > high) std::swap(low, high);
  if (!(low < high)) fail(params.at(), params.what(), ": \"zmin\" and \"zmax\" are equal");
  return revolve({{0, radius, low}, {1, radius, high}}, sweep(params));
}

Mesh make_disk(const Params& params) {
  const double radius = positive(params, "radius", 1), height = params.number("height", 0);
  const double inner = params.number("innerradius", 0);
  if (!(inner >= 0 && inner < radius))
    fail(params.at(), params.what(), ": \"innerradius\" must be in [0, radius), got ", inner);
  // pbrt's v runs from the rim to the middle, which puts the front on +z.
  return revolve({{0, radius, height}, {1, inner, height}}, sweep(params));
}

}  // namespace lte::scene::pbrt
