// Rounded boxes and cushions.
#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::homes {
namespace {

/// One line of a rounded box's grid along an axis: its place on the cube of directions, and on the
/// inner box to which the rounding is added.
struct Line {
  float direction, inner;
};

std::vector<Line> grid_lines(float low, float high, int bevel, float cell_m) {
  std::vector<Line> lines;
  const auto slope = [&](int i) {  // equal angles; the ends are exactly 0 and 1
    if (i == bevel) return 1.0f;
    return std::tan(kPi / 4 * static_cast<float>(i) / static_cast<float>(bevel));
  };
  for (int i = bevel; i >= 0; --i) lines.push_back({-slope(i), low});
  const float length = high - low;
  if (length > 1e-6f) {
    const int cells =
        std::isfinite(cell_m) ? std::max(1, static_cast<int>(std::ceil(length / cell_m))) : 1;
    for (int i = 1; i < cells; ++i)
      lines.push_back({0, low + length * static_cast<float>(i) / static_cast<float>(cells)});
    lines.push_back({0, high});
  }
  for (int i = 1; i <= bevel; ++i) lines.push_back({slope(i), high});
  return lines;
}

/// Adds two triangles over grid vertices (i, j), (i+1, j), ... of a grid with `stride` vertices a
/// row.
void add_cell(Mesh* mesh, uint32_t at, uint32_t stride, bool flip) {
  const uint32_t a = at, b = at + 1, c = at + stride + 1, d = at + stride;
  if (flip) {
    mesh->triangles.push_back({a, c, b});
    mesh->triangles.push_back({a, d, c});
  } else {
    mesh->triangles.push_back({a, b, c});
    mesh->triangles.push_back({a, c, d});
  }
}

int longest_axis(const Vec3& v) { return v.x >= v.y && v.x >= v.z ? 0 : (v.y >= v.z ? 1 : 2); }

}  // namespace

Mesh rounded_box(const Vec3& low, const Vec3& high, float radius, int bevel, float cell_m) {
  Mesh mesh;
  const Vec3 size = high - low;
  const float r = std::min(radius, 0.5f * std::min({size.x, size.y, size.z}));
  std::array<std::vector<Line>, 3> lines;
  for (int axis = 0; axis < 3; ++axis) {
    const float from = low[axis] + r, to = std::max(high[axis] - r, from);
    lines[static_cast<size_t>(axis)] = grid_lines(from, to, bevel, cell_m);
  }
  const int grain = longest_axis(size);
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto &across = lines[static_cast<size_t>(a)], &up = lines[static_cast<size_t>(b)];
    const int u_axis = b == grain ? b : a, v_axis = u_axis == a ? b : a;
    for (const bool top : {false, true}) {
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      for (const Line& v : up) {
        for (const Line& u : across) {
          Vec3 direction, inner;
          direction[axis] = top ? 1.0f : -1.0f;
          direction[a] = u.direction;
          direction[b] = v.direction;
          inner[axis] = top ? lines[static_cast<size_t>(axis)].back().inner
                            : lines[static_cast<size_t>(axis)].front().inner;
          inner[a] = u.inner;
          inner[b] = v.inner;
          const Vec3 p = inner + normalize(direction) * r;
          mesh.positions.push_back(p);
          mesh.uvs[0].push_back({p[u_axis] - low[u_axis], p[v_axis] - low[v_axis]});
        }
      }
      const auto stride = static_cast<uint32_t>(across.size());
      for (uint32_t j = 0; j + 1 < up.size(); ++j)
        for (uint32_t i = 0; i + 1 < stride; ++i)
          add_cell(&mesh, first + j * stride + i, stride, !top);
    }
  }
  return mesh;
}

Mesh cushion(const Vec3& size, int turn, float seam_m) {
  // Latitude from bottom to top; longitudes trace a rounded rectangle, the seam is the equator.
  Mesh mesh;
  const int rows = std::max(8, turn / 2 / 2 * 2), columns = turn;
  const auto power = [](float x, float e) { return std::copysign(std::pow(std::abs(x), e), x); };
  for (int j = 0; j <= rows; ++j) {
    const float t = 2 * static_cast<float>(j) / static_cast<float>(rows) - 1;  // −1 to 1
    const float latitude = t * kPi / 2;
    const float ring = j == 0 || j == rows ? 0.0f : std::pow(std::cos(latitude), 0.55f);
    const float seam = j == rows / 2 ? seam_m : 0.0f;
    for (int i = 0; i <= columns; ++i) {
      const int k = i % columns;  // the seam of the UVs closes bit for bit
      const float phi = 2 * kPi * static_cast<float>(k) / static_cast<float>(columns);
      const float c = power(std::cos(phi), 0.45f), s = power(std::sin(phi), 0.45f);
      // Corners hold less filling than the middle.
      const float corner = 1 - 0.55f * std::pow(std::abs(c * s) * ring, 2.0f);
      const float y = 0.5f * size.y * power(std::sin(latitude), 0.8f) * corner;
      mesh.positions.push_back(
          {(0.5f * size.x * ring + seam) * c, y, (0.5f * size.z * ring + seam) * s});
      const Vec3& p = mesh.positions.back();
      mesh.uvs[0].push_back({p.x + 0.5f * size.x, p.z + 0.5f * size.z});
    }
  }
  const auto stride = static_cast<uint32_t>(columns + 1);
  for (uint32_t j = 0; j < static_cast<uint32_t>(rows); ++j) {
    for (uint32_t i = 0; i + 1 < stride; ++i) {
      const uint32_t a = j * stride + i, b = a + 1, c = b + stride, d = a + stride;
      if (j > 0) mesh.triangles.push_back({a, c, b});
      if (j + 1 < static_cast<uint32_t>(rows)) mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

}  // namespace lte::datagen::homes
