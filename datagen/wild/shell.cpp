#include "datagen/wild/shell.h"

#include <algorithm>
#include <cmath>

#include "datagen/wild/ceiling.h"

namespace lte::datagen::wild {
namespace {

/// A flat convex polygon as a fan, with UVs in metres along its first edge.
void add_fan(const std::vector<Vec3>& corners, Mesh* mesh) {
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  const Vec3 normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
  const Vec3 u = normalize(corners[1] - corners[0]), v = cross(normal, u);
  for (const Vec3& p : corners) {
    mesh->positions.push_back(p);
    mesh->uvs[0].push_back({dot(p - corners[0], u), -dot(p - corners[0], v)});
  }
  for (uint32_t i = 1; i + 1 < corners.size(); ++i)
    if (length(cross(corners[i] - corners[0], corners[i + 1] - corners[0])) > 1e-9f)
      mesh->triangles.push_back({first, first + i, first + i + 1});
}

/// Where the pieces of a wall meet: corners of the top and of the holes, and where the two cross.
std::vector<float> cuts_of(float length, const std::vector<Vec2>& top,
                           const std::vector<Hole>& holes) {
  std::vector<float> cuts;
  for (const Vec2& p : top) cuts.push_back(p.x);
  for (const Hole& hole : holes) {
    for (const Vec2& p : hole.top) cuts.push_back(p.x);
    const float y = hole.top.front().y;
    for (size_t i = 0; i + 1 < top.size(); ++i) {
      const float a = top[i].y - y, b = top[i + 1].y - y;
      if (a * b < 0) cuts.push_back(top[i].x + (top[i + 1].x - top[i].x) * (a / (a - b)));
    }
  }
  for (float& cut : cuts) cut = std::clamp(cut, 0.0f, length);
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [](float a, float b) { return b - a < 1e-5f; }),
             cuts.end());
  return cuts;
}

/// A piece of wall between two uprights; nothing where it has no height.
void add_piece(const Edge& edge, const Vec2& u, const Vec2& low, const Vec2& high, Mesh* mesh) {
  const float left = std::max(high.x - low.x, 0.0f), right = std::max(high.y - low.y, 0.0f);
  if (std::max(left, right) < 1e-5f) return;
  const Vec2 p = edge.at(u.x), q = edge.at(u.y);
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  const auto corner = [&](const Vec2& at, float along, float y) {
    mesh->positions.push_back(in_space(at, y));
    mesh->uvs[0].push_back({along, -y});
  };
  corner(p, u.x, low.x);
  corner(q, u.y, low.y);
  corner(q, u.y, low.y + right);
  corner(p, u.x, low.x + left);
  if (right > 1e-6f) mesh->triangles.push_back({first, first + 1, first + 2});
  if (left > 1e-6f) mesh->triangles.push_back({first, first + 2, first + 3});
}

/// The outline of a hole, counter-clockwise seen from inside the room.
std::vector<Vec2> ring_of(const Hole& hole) {
  std::vector<Vec2> ring{{hole.u0, hole.low}, {hole.u1, hole.low}};
  for (auto p = hole.top.rbegin(); p != hole.top.rend(); ++p) ring.push_back(*p);
  return ring;
}

/// The sides of a hole, as deep as the wall.
Mesh reveal_mesh(const Edge& edge, const Hole& hole) {
  const std::vector<Vec2> ring = ring_of(hole);
  Mesh mesh;
  const Vec2 out = edge.inward * -hole.depth;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if (length(b - a) < 1e-5f) continue;
    const Vec2 p = edge.at(a.x), q = edge.at(b.x);
    add_fan({in_space(p, a.y), in_space(p + out, a.y), in_space(q + out, b.y), in_space(q, b.y)},
            &mesh);
  }
  return mesh;
}

Mesh ceiling_mesh(const Cell& cell) {
  Mesh mesh;
  if (cell.ceiling.kind == CeilingKind::None) return mesh;
  for (const std::vector<Vec3>& facet : facets(cell)) add_fan(facet, &mesh);
  return mesh;
}

Mesh floor_mesh(const Cell& cell) {
  std::vector<Vec3> corners;
  for (auto p = cell.outline.rbegin(); p != cell.outline.rend(); ++p)
    corners.push_back(in_space(*p, cell.floor));
  Mesh mesh;
  add_fan(corners, &mesh);
  return mesh;
}

}  // namespace

Mesh wall_mesh(const Edge& edge, float floor, const std::vector<Vec2>& top,
               const std::vector<Hole>& holes) {
  Mesh mesh;
  std::vector<Hole> sorted = holes;
  std::sort(sorted.begin(), sorted.end(),
            [](const Hole& a, const Hole& b) { return a.low < b.low; });
  const std::vector<float> cuts = cuts_of(edge.length, top, holes);
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Vec2 u{cuts[i], cuts[i + 1]};
    const float middle = 0.5f * (u.x + u.y);
    const Vec2 roof{height_on(top, u.x), height_on(top, u.y)};
    Vec2 low{floor, floor};
    for (const Hole& hole : sorted) {
      if (middle < hole.u0 || middle > hole.u1) continue;
      const float sill = std::max(hole.low, floor);
      add_piece(edge, u, low, {std::min(sill, roof.x), std::min(sill, roof.y)}, &mesh);
      low = {std::max(low.x, height_on(hole.top, u.x)), std::max(low.y, height_on(hole.top, u.y))};
    }
    add_piece(edge, u, low, roof, &mesh);
  }
  return mesh;
}

Mesh pane_mesh(const Edge& edge, const Hole& hole) {
  std::vector<Vec3> corners;
  for (const Vec2& p : ring_of(hole))
    corners.push_back(in_space(edge.at(p.x) - edge.inward * hole.depth, p.y));
  Mesh mesh;
  add_fan(corners, &mesh);
  return mesh;
}

void build_shell(Builder* builder, Dice* dice, int emitter) {
  const auto material = [&](int own) { return emitter != scene::kNone ? emitter : own; };
  for (const Cell& cell : builder->plan->cells) {
    const int walls = builder->materials->shell();
    builder->add(floor_mesh(cell), material(builder->materials->shell()), {}, "floor");
    builder->add(ceiling_mesh(cell), material(builder->materials->shell()), {}, "ceiling");
    for (size_t e = 0; e < cell.outline.size(); ++e) {
      const Edge edge = edge_of(cell.outline, e);
      const bool own = cell.outline.size() <= 8 && dice->chance(0.25f);
      const int wall = material(own ? builder->materials->shell() : walls);
      builder->add(wall_mesh(edge, cell.floor, cell.top_of(e), cell.holes[e]), wall, {}, "wall");
      for (const Hole& hole : cell.holes[e])
        if (hole.reveal) builder->add(reveal_mesh(edge, hole), wall, {}, "reveal");
    }
  }
}

}  // namespace lte::datagen::wild
