// Transforms and measures of meshes.
#include <algorithm>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::homes {

int Detail::turn(float radius_m) const {
  return 4 * std::max(2, static_cast<int>(std::lround(level * (3 + 10 * std::sqrt(radius_m)))));
}

int Detail::bevel() const { return std::max(1, static_cast<int>(std::lround(1.4f * level))); }

int Detail::steps(float length_m, float step) const {
  return std::max(1, static_cast<int>(std::lround(level * length_m / step)));
}

Mesh panel(const Vec3& corner, const Vec3& right, const Vec3& up) {
  Mesh mesh;
  mesh.positions = {corner, corner + right, corner + right + up, corner + up};
  mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

void displace(Mesh* mesh, const std::function<Vec3(const Vec3&)>& offset) {
  for (Vec3& p : mesh->positions) p += offset(p);
}

void square_off(Mesh* mesh, float power) {
  displace(mesh, [power](const Vec3& p) {
    const float r = std::hypot(p.x, p.z);
    if (r == 0) return Vec3{};
    const float norm = std::pow(
        std::pow(std::abs(p.x / r), power) + std::pow(std::abs(p.z / r), power), 1 / power);
    return Vec3{p.x, 0, p.z} * (1 / norm - 1);
  });
}

void append(Mesh* mesh, const Mesh& part, const Affine& to_mesh) {
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  const bool mirrored = to_mesh.determinant() < 0;
  for (const Vec3& p : part.positions) mesh->positions.push_back(to_mesh.point(p));
  mesh->uvs[0].insert(mesh->uvs[0].end(), part.uvs[0].begin(), part.uvs[0].end());
  for (const auto& t : part.triangles) {
    if (mirrored) {
      mesh->triangles.push_back({first + t[0], first + t[2], first + t[1]});
    } else {
      mesh->triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
}

void fit_uvs(Mesh* mesh, const Vec2& low, const Vec2& high) {
  Vec2 from{INFINITY, INFINITY}, to{-INFINITY, -INFINITY};
  for (const Vec2& uv : mesh->uvs[0]) {
    from = {std::min(from.x, uv.x), std::min(from.y, uv.y)};
    to = {std::max(to.x, uv.x), std::max(to.y, uv.y)};
  }
  const Vec2 span{std::max(to.x - from.x, 1e-6f), std::max(to.y - from.y, 1e-6f)};
  for (Vec2& uv : mesh->uvs[0]) {
    uv = {low.x + (uv.x - from.x) / span.x * (high.x - low.x),
          low.y + (uv.y - from.y) / span.y * (high.y - low.y)};
  }
}

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const Vec3& p : mesh.positions) bounds.extend(p);
  return bounds;
}

double volume_of(const Mesh& mesh) {
  double sum = 0;
  if (mesh.positions.empty()) return 0;
  const Vec3 origin = mesh.positions.front();  // near by, so that small parts far out stay exact
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin,
               c = mesh.positions[t[2]] - origin;
    sum += static_cast<double>(dot(a, cross(b, c))) / 6;
  }
  return sum;
}

Affine translation(const Vec3& by) {
  Affine a;
  for (int axis = 0; axis < 3; ++axis) a.m[static_cast<size_t>(axis)][3] = by[axis];
  return a;
}

Affine rotation(int axis, double degrees) {
  const double radians = degrees * M_PI / 180;
  const auto c = static_cast<float>(std::cos(radians)), s = static_cast<float>(std::sin(radians));
  const auto i = static_cast<size_t>((axis + 1) % 3), j = static_cast<size_t>((axis + 2) % 3);
  Affine a;
  a.m[i][i] = a.m[j][j] = c;
  a.m[i][j] = -s;
  a.m[j][i] = s;
  return a;
}

Affine scaling(const Vec3& by) {
  Affine a;
  for (int axis = 0; axis < 3; ++axis)
    a.m[static_cast<size_t>(axis)][static_cast<size_t>(axis)] = by[axis];
  return a;
}

}  // namespace lte::datagen::homes
