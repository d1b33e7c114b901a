#include "datagen/wild/builder.h"

#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::wild {

void Builder::add(Mesh&& mesh, int material, const Affine& at, const std::string& name) {
  if (mesh.triangles.empty()) return;
  mesh.material = material;
  mesh.name = name;
  const bool emits = scene->materials[static_cast<size_t>(material)].emissive();
  scene->instances.push_back(
      {static_cast<int>(scene->meshes.size()), at, emits ? group : scene::kNone});
  scene->meshes.push_back(std::move(mesh));
}

void Builder::add(homes::Piece&& piece, const Affine& at) {
  for (auto& [material, mesh] : piece.meshes) add(std::move(mesh), material, at, piece.name);
}

void Builder::next_group() {
  const int groups = static_cast<int>(scene->light_groups.size());
  new_group_ = groups < kMaxGroups;
  group = new_group_ ? groups : shared_++ % kMaxGroups;
  if (new_group_) scene->light_groups.push_back("lamps " + std::to_string(groups));
}

void Builder::drop_group() {
  if (new_group_) scene->light_groups.pop_back();
}

bool Builder::is_free(int cell, const OrientedBox& box, float gap) const {
  const auto& boxes = taken[static_cast<size_t>(cell)];
  return std::all_of(boxes.begin(), boxes.end(),
                     [&](const OrientedBox& other) { return homes::apart(box, other, gap); });
}

bool Builder::fits(int cell, const OrientedBox& box, float margin) const {
  const Cell& room = plan->cells[static_cast<size_t>(cell)];
  if (box.low < room.floor - 1e-4f) return false;
  for (const Vec2& p : outline_of(box))
    if (!inside(room.outline, p, margin) || room.height_at(p) < box.high + 0.5f * margin)
      return false;
  return true;
}

Affine edge_frame(const Cell& cell, size_t index) {
  const Edge edge = edge_of(cell.outline, index);
  Affine out;
  out.m = {{{edge.along.x, 0, edge.inward.x, edge.from.x},
            {0, 1, 0, cell.floor},
            {edge.along.y, 0, edge.inward.y, edge.from.y}}};
  return out;
}

Affine standing(const Vec2& at, float y, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  Affine out;
  out.m = {{{c, 0, s, at.x}, {0, 1, 0, y}, {-s, 0, c, at.y}}};
  return out;
}

Polygon outline_of(const OrientedBox& box) {
  const Vec2 x = box.axis * box.half.x, z = left_of(box.axis) * box.half.y;
  return {box.centre - x - z, box.centre + x - z, box.centre + x + z, box.centre - x + z};
}

Mesh block(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  const Vec3 size = high - low, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  for (const Mesh& face :
       {sheet_of(low, z, y), sheet_of(low + x + z, -z, y), sheet_of(low + x, -x, y),
        sheet_of(low + z, x, y), sheet_of(low, x, z), sheet_of(low + y + z, x, -z)})
    homes::append(&mesh, face, {});
  return mesh;
}

Mesh sheet_of(const Vec3& corner, const Vec3& right, const Vec3& up) {
  Mesh mesh = homes::panel(corner, right, up);
  homes::fit_uvs(&mesh, {0, 0}, {length(right), length(up)});
  return mesh;
}

Mesh ball(const Vec3& centre, float radius, int turn) {
  Mesh mesh = homes::sphere(radius, turn);
  for (Vec3& p : mesh.positions) p += centre;
  return mesh;
}

}  // namespace lte::datagen::wild
