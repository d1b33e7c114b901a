#include "datagen/homes/piece.h"

#include <algorithm>
#include <cmath>

#include "datagen/common/parts.h"

namespace lte::datagen::homes {

void Piece::add(const Mesh& part, int material, const Affine& at, bool solid) {
  append(&meshes[material], part, at);
  if (solid) solids.push_back(transformed(bounds_of(part), at));
}

void Piece::add(const Piece& other, const Affine& at) {
  for (const auto& [material, mesh] : other.meshes) append(&meshes[material], mesh, at);
  for (const Bounds& box : other.solids) solids.push_back(transformed(box, at));
  for (const PointLight& light : other.point_lights)
    point_lights.push_back({at.point(light.position), light.intensity});
}

Bounds Piece::bounds() const {
  Bounds all;
  for (const auto& [material, mesh] : meshes)
    for (const Vec3& p : mesh.positions) all.extend(p);
  return all;
}

OrientedBox oriented_box(const Bounds& local, const Affine& at) {
  OrientedBox box;
  const Vec3 centre = at.point(local.center()), half = local.extent() * 0.5f;
  box.centre = {centre.x, centre.z};
  box.half = {half.x, half.z};
  box.axis = {at.m[0][0], at.m[2][0]};
  box.low = centre.y - half.y;
  box.high = centre.y + half.y;
  return box;
}

bool apart(const OrientedBox& a, const OrientedBox& b, float gap) {
  if (a.low >= b.high + gap || b.low >= a.high + gap) return true;
  const Vec2 between{b.centre.x - a.centre.x, b.centre.y - a.centre.y};
  const auto reach = [](const OrientedBox& box, const Vec2& n) {
    return box.half.x * std::abs(box.axis.x * n.x + box.axis.y * n.y) +
           box.half.y * std::abs(-box.axis.y * n.x + box.axis.x * n.y);
  };
  for (const OrientedBox* box : {&a, &b}) {
    for (const Vec2& n : {box->axis, Vec2{-box->axis.y, box->axis.x}}) {
      const float distance = std::abs(between.x * n.x + between.y * n.y);
      if (distance >= reach(a, n) + reach(b, n) + gap) return true;
    }
  }
  return false;
}

Bounds bounds_of(const OrientedBox& box) {
  const float x = box.half.x * std::abs(box.axis.x) + box.half.y * std::abs(box.axis.y);
  const float z = box.half.x * std::abs(box.axis.y) + box.half.y * std::abs(box.axis.x);
  return {{box.centre.x - x, box.low, box.centre.y - z},
          {box.centre.x + x, box.high, box.centre.y + z}};
}

}  // namespace lte::datagen::homes
