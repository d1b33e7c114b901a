// What closed meshes promise, checked without the code that makes them.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "lte/scene/scene.h"

namespace lte::datagen::test {

/// Empty if, with vertices of equal position taken as one, every directed edge occurs once and its
/// reverse occurs once; otherwise what is wrong.
inline std::string closedness_fault(const scene::Mesh& mesh) {
  std::map<std::array<float, 3>, int> welded;
  const auto vertex = [&](uint32_t i) {
    const Vec3& p = mesh.positions[i];
    return welded.try_emplace({p.x, p.y, p.z}, static_cast<int>(welded.size())).first->second;
  };
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : mesh.triangles) {
    const int v[] = {vertex(t[0]), vertex(t[1]), vertex(t[2])};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return "a triangle without area";
    for (int i = 0; i < 3; ++i) ++edges[{v[i], v[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    if (count != 1) return "an edge that two triangles run along the same way";
    if (!edges.contains({edge.second, edge.first})) return "an open edge";
  }
  return mesh.triangles.empty() ? "no triangles" : "";
}

inline double area_of(const scene::Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    sum += 0.5 * static_cast<double>(length(cross(b - a, c - a)));
  }
  return sum;
}

/// Sum of a · (b × c) / 6 about the origin, in double.
inline double enclosed_volume(const scene::Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> p;
    for (size_t i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis)
        p[i][static_cast<size_t>(axis)] = mesh.positions[t[i]][axis];
    sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
           p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
  }
  return sum / 6;
}

}  // namespace lte::datagen::test
