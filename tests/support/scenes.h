// Scenes built in code for tests, and the few transforms they need.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::test {

inline Affine translation(const Vec3& t) {
  Affine out;
  for (int i = 0; i < 3; ++i) out.m[i][3] = t[i];
  return out;
}

inline Affine scaling(const Vec3& s) {
  Affine out;
  for (int i = 0; i < 3; ++i) out.m[i][i] = s[i];
  return out;
}

/// Rotation about a unit axis (Rodrigues).
inline Affine rotation(const Vec3& axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  Affine out;
  for (int i = 0; i < 3; ++i) {
    Vec3 e{};
    e[i] = 1;
    const Vec3 column = e * c + cross(axis, e) * s + axis * (axis[i] * (1 - c));
    for (int row = 0; row < 3; ++row) out.m[row][i] = column[row];
  }
  return out;
}

inline int add_material(scene::Scene* scene, const Rgb& albedo, const Rgb& emission = {},
                        bool double_sided = false) {
  scene::Material material;
  material.name = "material" + std::to_string(scene->materials.size());
  material.base_color = albedo;
  material.emission = emission;
  material.double_sided = double_sided;
  scene->materials.push_back(material);
  return static_cast<int>(scene->materials.size()) - 1;
}

inline int add_metal(scene::Scene* scene, const Rgb& color, float roughness, float metallic = 1) {
  const int index = add_material(scene, color);
  scene->materials.back().metallic = metallic;
  scene->materials.back().roughness = roughness;
  return index;
}

/// Appends a parallelogram; its front is on the side of edge1 × edge2. UV runs along the edges from
/// (0, 0) to (1, 1).
inline void append_quad(scene::Mesh* mesh, const Vec3& corner, const Vec3& edge1,
                        const Vec3& edge2) {
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  for (const Vec3& p : {corner, corner + edge1, corner + edge1 + edge2, corner + edge2}) {
    mesh->positions.push_back(p);
  }
  for (const Vec2& uv : {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}}) {
    mesh->uvs[0].push_back(uv);
  }
  mesh->triangles.push_back({first, first + 1, first + 2});
  mesh->triangles.push_back({first, first + 2, first + 3});
}

inline scene::Mesh quad_mesh(const Vec3& corner, const Vec3& edge1, const Vec3& edge2,
                             int material) {
  scene::Mesh mesh;
  mesh.name = "quad";
  mesh.material = material;
  append_quad(&mesh, corner, edge1, edge2);
  return mesh;
}

/// An axis-aligned box whose faces look inwards (a room) or outwards (an object).
inline scene::Mesh box_mesh(const Vec3& low, const Vec3& high, int material, bool inwards) {
  scene::Mesh mesh;
  mesh.name = inwards ? "room" : "box";
  mesh.material = material;
  const Vec3 e = high - low;
  const Vec3 x{e.x, 0, 0}, y{0, e.y, 0}, z{0, 0, e.z};
  const auto face = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
    append_quad(&mesh, corner, inwards ? a : b, inwards ? b : a);
  };
  face(low, y, z);      // its normal is +x
  face(low + x, z, y);  // −x
  face(low, z, x);      // +y
  face(low + y, x, z);  // −y
  face(low, x, y);      // +z
  face(low + z, y, x);  // −z
  return mesh;
}

/// A sphere by subdivided octahedron, faces inwards.
inline scene::Mesh inward_sphere_mesh(float radius, int subdivisions, int material) {
  scene::Mesh mesh;
  mesh.name = "sphere";
  mesh.material = material;
  const auto add = [&](const auto& self, Vec3 a, Vec3 b, Vec3 c, int level) -> void {
    if (level == 0) {
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      for (const Vec3& p : {a, c, b}) mesh.positions.push_back(p * radius);
      mesh.triangles.push_back({first, first + 1, first + 2});
      return;
    }
    const Vec3 ab = normalize(a + b), bc = normalize(b + c), ca = normalize(c + a);
    self(self, a, ab, ca, level - 1);
    self(self, ab, b, bc, level - 1);
    self(self, ca, bc, c, level - 1);
    self(self, ab, bc, ca, level - 1);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 x{octant & 1 ? -1.0f : 1.0f, 0, 0}, y{0, octant & 2 ? -1.0f : 1.0f, 0},
        z{0, 0, octant & 4 ? -1.0f : 1.0f};
    const bool mirrored = ((octant & 1) + ((octant >> 1) & 1) + ((octant >> 2) & 1)) % 2 == 1;
    add(add, x, mirrored ? z : y, mirrored ? y : z, subdivisions);
  }
  return mesh;
}

/// Adds the mesh with one instance; an emissive one gets a light group of its own unless `group`
/// names one.
inline int add_instance(scene::Scene* scene, scene::Mesh mesh, const Affine& to_world = {},
                        int group = scene::kNone) {
  const bool emissive = scene->materials[mesh.material].emissive();
  if (emissive && group == scene::kNone) {
    group = static_cast<int>(scene->light_groups.size());
    scene->light_groups.push_back("light" + std::to_string(group));
  }
  scene->meshes.push_back(std::move(mesh));
  scene->instances.push_back(
      {static_cast<int>(scene->meshes.size()) - 1, to_world, emissive ? group : scene::kNone});
  return static_cast<int>(scene->instances.size()) - 1;
}

inline int add_quad(scene::Scene* scene, const Vec3& corner, const Vec3& edge1, const Vec3& edge2,
                    int material) {
  return add_instance(scene, quad_mesh(corner, edge1, edge2, material));
}

inline void add_point_light(scene::Scene* scene, const Vec3& position, const Rgb& intensity) {
  scene::PunctualLight light;
  light.name = "point";
  light.position = position;
  light.intensity = intensity;
  light.light_group = static_cast<int>(scene->light_groups.size());
  scene->light_groups.push_back(light.name);
  scene->lights.push_back(light);
}

/// A closed room [0, 4] × [0, 2.5] × [0, 3] m with colored walls, two boxes and two ceiling lights
/// of different color.
inline scene::Scene furnished_room() {
  scene::Scene scene;
  scene.name = "room";
  const int white = add_material(&scene, {0.8f, 0.8f, 0.8f});
  const int red = add_material(&scene, {0.7f, 0.15f, 0.1f});
  const int green = add_material(&scene, {0.15f, 0.5f, 0.2f});
  const int warm = add_material(&scene, {0.5f, 0.5f, 0.5f}, {12, 9, 6});
  const int cold = add_material(&scene, {0.5f, 0.5f, 0.5f}, {3, 5, 9});
  add_instance(&scene, box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  add_instance(&scene, box_mesh({0.5f, 0, 0.5f}, {1.3f, 1.1f, 1.4f}, red, false));
  add_instance(&scene, box_mesh({-0.4f, 0, -0.3f}, {0.4f, 0.7f, 0.3f}, green, false),
               translation({2.8f, 0, 1.9f}) * rotation({0, 1, 0}, 0.6f));
  // Fronts look down: x × z = −y.
  add_quad(&scene, {0.8f, 2.45f, 0.8f}, {0.6f, 0, 0}, {0, 0, 0.6f}, warm);
  add_quad(&scene, {2.6f, 2.4f, 1.5f}, {0.4f, 0, 0}, {0, 0, 0.8f}, cold);
  return scene;
}

/// A hall of 20 m with 10 x 10 small lamps under its ceiling, a spot, a sun and a bulb.
inline scene::Scene hall_of_lamps() {
  scene::Scene scene;
  scene.name = "hall";
  const int gray = add_material(&scene, {0.5f, 0.5f, 0.5f});
  const int lamp = add_material(&scene, {0, 0, 0}, {50, 40, 30});
  add_instance(&scene, box_mesh({0, 0, 0}, {20, 3, 20}, gray, true));
  scene::Mesh lamps;
  lamps.material = lamp;
  for (int i = 0; i < 100; ++i) {
    append_quad(
        &lamps,
        {2.0f * static_cast<float>(i % 10) + 0.9f, 2.9f, 2.0f * static_cast<float>(i / 10) + 0.9f},
        {0.1f, 0, 0}, {0, 0, 0.1f});
  }
  add_instance(&scene, std::move(lamps));
  add_point_light(&scene, {4, 1, 4}, {0.5f, 0.5f, 0.5f});
  add_point_light(&scene, {12, 2, 4}, {2, 2, 2});
  scene.lights[1].kind = scene::LightKind::Spot;
  scene.lights[1].direction = {0, -1, 0};
  return scene;
}

/// A hollow thing that is no room: two shells, of which the outer one faces outwards, and a level
/// bottom inside.
inline scene::Scene vessel() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  add_instance(&scene, inward_sphere_mesh(40, 4, white));
  scene::Mesh outer = inward_sphere_mesh(41, 4, white);
  for (auto& triangle : outer.triangles) std::swap(triangle[0], triangle[1]);
  add_instance(&scene, outer);
  add_quad(&scene, {-20, -33, -20}, {0, 0, 40}, {40, 0, 0}, white);
  return scene;
}

}  // namespace lte::test
