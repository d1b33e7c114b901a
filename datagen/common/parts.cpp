#include "datagen/common/parts.h"

#include <cmath>
#include <map>

namespace lte::datagen {
namespace {

/// A quadrilateral whose corners run counter-clockwise seen from the front.
void add_quad(scene::Mesh* mesh, const std::array<Vec3, 4>& corners, const std::array<Vec2, 4>& uvs,
              bool flip) {
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  for (size_t i = 0; i < 4; ++i) {
    mesh->positions.push_back(corners[i]);
    mesh->uvs[0].push_back(uvs[i]);
  }
  if (flip) {
    mesh->triangles.push_back({first, first + 2, first + 1});
    mesh->triangles.push_back({first, first + 3, first + 2});
  } else {
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangles.push_back({first, first + 2, first + 3});
  }
}

void add_box(scene::Mesh* mesh, const Part& part) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if (!(part.faces & (1u << (2 * axis + side)))) continue;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      std::array<Vec3, 4> corners;
      std::array<Vec2, 4> uvs;
      // Upright faces carry v downwards from the top, as pictures do.
      const int u_axis = axis == 0 ? 2 : 0, v_axis = axis == 1 ? 2 : 1;
      for (size_t i = 0; i < 4; ++i) {
        Vec3& p = corners[i];
        p[axis] = side ? part.high[axis] : part.low[axis];
        p[a] = i == 1 || i == 2 ? part.high[a] : part.low[a];
        p[b] = i >= 2 ? part.high[b] : part.low[b];
        uvs[i] = {p[u_axis] - part.low[u_axis], v_axis == 1 ? part.high.y - p.y : p.z - part.low.z};
      }
      add_quad(mesh, corners, uvs, (side == 0) != part.inward);
    }
  }
}

void add_cylinder(scene::Mesh* mesh, const Part& part) {
  const Vec3 centre = (part.low + part.high) * 0.5f, radius = (part.high - part.low) * 0.5f;
  const auto rim = [&](int i) {
    const double angle = 2 * M_PI * (i % part.segments) / part.segments;
    return Vec2{centre.x + radius.x * static_cast<float>(std::cos(angle)),
                centre.z + radius.z * static_cast<float>(std::sin(angle))};
  };
  const float y0 = part.low.y, y1 = part.high.y, arc = 2 * kPi * radius.x / part.segments;
  for (int i = 0; i < part.segments; ++i) {
    const Vec2 p = rim(i), q = rim(i + 1);
    if (part.faces & kSides) {
      const float u0 = arc * static_cast<float>(i), u1 = u0 + arc;
      add_quad(mesh, {Vec3{p.x, y0, p.y}, {p.x, y1, p.y}, {q.x, y1, q.y}, {q.x, y0, q.y}},
               {Vec2{u0, y1 - y0}, {u0, 0}, {u1, 0}, {u1, y1 - y0}}, part.inward);
    }
    for (const bool top : {false, true}) {
      if (!(part.faces & (top ? kPosY : kNegY))) continue;
      const auto first = static_cast<uint32_t>(mesh->positions.size());
      const float y = top ? y1 : y0;
      for (const Vec3& v : {Vec3{centre.x, y, centre.z}, {p.x, y, p.y}, {q.x, y, q.y}}) {
        mesh->positions.push_back(v);
        mesh->uvs[0].push_back({v.x - part.low.x, v.z - part.low.z});
      }
      if (top != part.inward) {
        mesh->triangles.push_back({first, first + 2, first + 1});
      } else {
        mesh->triangles.push_back({first, first + 1, first + 2});
      }
    }
  }
}

}  // namespace

Bounds Assembly::bounds() const {
  Bounds bounds;
  for (const Part& part : parts) {
    bounds.extend(part.low);
    bounds.extend(part.high);
  }
  return bounds;
}

std::vector<int> add_meshes(scene::Scene* scene, const std::string& name,
                            const std::vector<Part>& parts) {
  std::map<int, scene::Mesh> meshes;
  for (const Part& part : parts) {
    scene::Mesh& mesh = meshes[part.material];
    if (part.segments > 0) {
      add_cylinder(&mesh, part);
    } else {
      add_box(&mesh, part);
    }
  }
  std::vector<int> indices;
  for (auto& [material, mesh] : meshes) {
    mesh.material = material;
    mesh.name = name;
    indices.push_back(static_cast<int>(scene->meshes.size()));
    scene->meshes.push_back(std::move(mesh));
  }
  return indices;
}

Affine placement(double degrees, const Vec3& translation) {
  const double quarters = degrees / 90;
  double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
  if (quarters == std::round(quarters)) {
    c = std::round(c);
    s = std::round(s);
  }
  Affine affine;
  affine.m = {{{static_cast<float>(c), 0, static_cast<float>(s), translation.x},
               {0, 1, 0, translation.y},
               {static_cast<float>(-s), 0, static_cast<float>(c), translation.z}}};
  return affine;
}

Bounds transformed(const Bounds& bounds, const Affine& to_world) {
  Bounds out;
  for (int corner = 0; corner < 8; ++corner) {
    out.extend(to_world.point({corner & 1 ? bounds.high.x : bounds.low.x,
                               corner & 2 ? bounds.high.y : bounds.low.y,
                               corner & 4 ? bounds.high.z : bounds.low.z}));
  }
  return out;
}

}  // namespace lte::datagen
