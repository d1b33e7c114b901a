// Swept profiles and thin sheets.
#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::homes {
namespace {

Vec2 unit(const Vec2& a, const Vec2& b) {
  const float length = std::hypot(b.x - a.x, b.y - a.y);
  return {(b.x - a.x) / length, (b.y - a.y) / length};
}

/// The offset to the left by one metre at a corner between two directions, longer where it is
/// mitred. Seen from above (y up), left of +x is −z.
Vec2 mitre(const Vec2& in, const Vec2& out) {
  const Vec2 left_in{in.y, -in.x}, left_out{out.y, -out.x};
  const float scale = 1 / (1 + left_in.x * left_out.x + left_in.y * left_out.y);
  return {(left_in.x + left_out.x) * scale, (left_in.y + left_out.y) * scale};
}

void add_quad(Mesh* mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  mesh->triangles.push_back({a, b, c});
  mesh->triangles.push_back({a, c, d});
}

/// Closes one end of an open sweep with a fan over the profile.
void add_cap(Mesh* mesh, const std::vector<Vec2>& profile, uint32_t row, bool end) {
  const auto first = static_cast<uint32_t>(mesh->positions.size()),
             count = static_cast<uint32_t>(profile.size());
  for (uint32_t i = 0; i < count; ++i) {
    mesh->positions.push_back(Vec3(mesh->positions[row + i]));
    mesh->uvs[0].push_back(profile[i]);
  }
  for (uint32_t i = 1; i + 1 < count; ++i) {
    if (end) {
      mesh->triangles.push_back({first, first + i + 1, first + i});
    } else {
      mesh->triangles.push_back({first, first + i, first + i + 1});
    }
  }
}

}  // namespace

Mesh sweep(const std::vector<Vec2>& path_xz, const std::vector<Vec2>& profile, bool closed) {
  Mesh mesh;
  const size_t n = path_xz.size(), p = profile.size();
  const size_t rows = closed ? n + 1 : n;
  const auto stride = static_cast<uint32_t>(p + 1);
  float along = 0;
  for (size_t j = 0; j < rows; ++j) {
    const Vec2& at = path_xz[j % n];
    const bool first = !closed && j == 0, last = !closed && j == n - 1;
    const Vec2 in = first ? Vec2{} : unit(path_xz[(j + n - 1) % n], at);
    const Vec2 out = last ? in : unit(at, path_xz[(j + 1) % n]);
    const Vec2 left = mitre(first ? out : in, out);
    if (j > 0) along += std::hypot(at.x - path_xz[j - 1].x, at.y - path_xz[j - 1].y);
    float around = 0;
    for (size_t i = 0; i <= p; ++i) {
      const Vec2& q = profile[i % p];
      if (i > 0) around += std::hypot(q.x - profile[i - 1].x, q.y - profile[i - 1].y);
      mesh.positions.push_back({at.x + left.x * q.x, q.y, at.y + left.y * q.x});
      mesh.uvs[0].push_back({along, around});
    }
  }
  for (uint32_t j = 0; j + 1 < rows; ++j) {
    for (uint32_t i = 0; i < p; ++i) {
      const uint32_t a = j * stride + i;
      add_quad(&mesh, a, a + stride, a + stride + 1, a + 1);
    }
  }
  if (!closed) {
    add_cap(&mesh, profile, 0, false);
    add_cap(&mesh, profile, static_cast<uint32_t>(n - 1) * stride, true);
  }
  if (volume_of(mesh) < 0)  // a clockwise closed path or profile
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

Mesh sheet(int cells_u, int cells_v, const std::function<Vec3(float, float)>& at, float thickness) {
  Mesh mesh;
  const auto columns = static_cast<uint32_t>(cells_u + 1),
             rows = static_cast<uint32_t>(cells_v + 1);
  std::vector<Vec3> grid;
  for (uint32_t j = 0; j < rows; ++j)
    for (uint32_t i = 0; i < columns; ++i)
      grid.push_back(at(static_cast<float>(i) / static_cast<float>(cells_u),
                        static_cast<float>(j) / static_cast<float>(cells_v)));
  const auto point = [&](uint32_t i, uint32_t j) { return grid[j * columns + i]; };
  std::vector<Vec2> uv(grid.size());
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t k = j * columns + i;
      if (i > 0) uv[k].x = uv[k - 1].x + length(point(i, j) - point(i - 1, j));
      if (j > 0) uv[k].y = uv[k - columns].y + length(point(i, j) - point(i, j - 1));
    }
  }
  // Far side first (offset along the normal), then near side.
  for (const float side : {0.5f, -0.5f}) {
    for (uint32_t j = 0; j < rows; ++j) {
      for (uint32_t i = 0; i < columns; ++i) {
        const Vec3 du = point(std::min(i + 1, columns - 1), j) - point(i > 0 ? i - 1 : 0, j);
        const Vec3 dv = point(i, std::min(j + 1, rows - 1)) - point(i, j > 0 ? j - 1 : 0);
        mesh.positions.push_back(point(i, j) + normalize(cross(du, dv)) * (side * thickness));
        mesh.uvs[0].push_back(uv[j * columns + i]);
      }
    }
  }
  const uint32_t back = rows * columns;
  for (uint32_t j = 0; j + 1 < rows; ++j) {
    for (uint32_t i = 0; i + 1 < columns; ++i) {
      const uint32_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
      add_quad(&mesh, a, b, c, d);
      add_quad(&mesh, back + a, back + d, back + c, back + b);
    }
  }
  const auto rim = [&](uint32_t a, uint32_t b) { add_quad(&mesh, a, back + a, back + b, b); };
  for (uint32_t i = 0; i + 1 < columns; ++i) {
    rim(i, i + 1);
    rim((rows - 1) * columns + i + 1, (rows - 1) * columns + i);
  }
  for (uint32_t j = 0; j + 1 < rows; ++j) {
    rim((j + 1) * columns, j * columns);
    rim(j * columns + columns - 1, (j + 1) * columns + columns - 1);
  }
  return mesh;
}

}  // namespace lte::datagen::homes
