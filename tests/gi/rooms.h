// Rooms in which light is bright and uneven in small places: what a table of light at few points
// finds hard. Lamps are sheets that shine from both sides, as exporters write them.
#pragma once

#include <cmath>
#include <utility>

#include "tests/support/scenes.h"

namespace lte::test {

/// Which way the walls of a room face. A sheet reflects on both sides, so light is the same.
enum class Winding { Inwards, Outwards };

inline void add_camera(scene::Scene* scene, const Vec3& origin, const Vec3& target,
                       float vfov = 75) {
  scene::Camera camera;
  camera.name = "inside";
  camera.origin = origin;
  camera.target = target;
  camera.vfov = vfov;
  scene->cameras.push_back(camera);
}

inline void add_room(scene::Scene* scene, const Vec3& low, const Vec3& high, int material,
                     Winding winding = Winding::Inwards) {
  add_instance(scene, box_mesh(low, high, material, winding == Winding::Inwards));
}

inline void add_block(scene::Scene* scene, const Vec3& low, const Vec3& high, int material) {
  add_instance(scene, box_mesh(low, high, material, false));
}

/// A level panel whose front looks down.
inline void add_panel(scene::Scene* scene, const Vec3& corner, float width, float depth, int lamp) {
  add_quad(scene, corner, {width, 0, 0}, {0, 0, depth}, lamp);
}

/// 4 × 2.6 × 4 m, a panel 5 cm under the ceiling, a box and a table.
inline scene::Scene panel_room(bool two_sided, Winding winding = Winding::Inwards) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.75f, 0.73f, 0.7f}, {}, true);
  const int wood = add_material(&scene, {0.45f, 0.3f, 0.2f}, {}, true);
  const int lamp = add_material(&scene, {0.5f, 0.5f, 0.5f}, {9, 8, 7}, two_sided);
  add_room(&scene, {0, 0, 0}, {4, 2.6f, 4}, white, winding);
  add_block(&scene, {0.4f, 0, 0.5f}, {1.2f, 0.9f, 1.2f}, wood);
  add_block(&scene, {2.2f, 0.7f, 1}, {3.4f, 0.75f, 1.8f}, wood);
  add_panel(&scene, {1.4f, 2.55f, 1.4f}, 1.2f, 0.6f, lamp);
  add_camera(&scene, {3.7f, 1.6f, 3.7f}, {1, 1, 0.8f});
  return scene;
}

/// Two rooms of 3 × 2.5 × 4 m; the door between them stands ajar by `degrees`, light is next door.
inline scene::Scene door_ajar(float degrees = 25) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.75f, 0.75f, 0.72f}, {}, true);
  const int door = add_material(&scene, {0.6f, 0.5f, 0.4f}, {}, true);
  const int lamp = add_material(&scene, {0.5f, 0.5f, 0.5f}, {14, 13, 12}, true);
  add_room(&scene, {0, 0, 0}, {3, 2.5f, 4}, white);
  add_room(&scene, {3.1f, 0, 0}, {6.1f, 2.5f, 4}, white);
  // The two walls with a doorway are put together anew: z in [1.5, 2.4], 2 m high.
  for (auto& mesh : scene.meshes) {
    std::vector<std::array<uint32_t, 3>> kept;
    for (const auto& triangle : mesh.triangles) {
      bool shared = true;
      for (const uint32_t corner : triangle) {
        const float x = mesh.positions[corner].x;
        shared &= x > 2.9f && x < 3.2f;
      }
      if (!shared) kept.push_back(triangle);
    }
    mesh.triangles = kept;
  }
  for (const float x : {3.0f, 3.1f}) {
    add_quad(&scene, {x, 0, 0}, {0, 2.5f, 0}, {0, 0, 1.5f}, white);
    add_quad(&scene, {x, 0, 2.4f}, {0, 2.5f, 0}, {0, 0, 1.6f}, white);
    add_quad(&scene, {x, 2, 1.5f}, {0, 0.5f, 0}, {0, 0, 0.9f}, white);
  }
  add_quad(&scene, {3, 0, 1.5f}, {0.1f, 0, 0}, {0, 2, 0}, white);
  add_quad(&scene, {3, 0, 2.4f}, {0.1f, 0, 0}, {0, 2, 0}, white);
  add_quad(&scene, {3, 2, 1.5f}, {0.1f, 0, 0}, {0, 0, 0.9f}, white);
  add_quad(&scene, {3, 0, 1.5f}, {0.1f, 0, 0}, {0, 0, 0.9f}, white);
  // Hinged at z = 1.5 on this side, it opens into this room.
  add_instance(&scene, box_mesh({-0.04f, 0.01f, 0}, {0, 1.99f, 0.9f}, door, false),
               translation({3, 0, 1.5f}) * rotation({0, 1, 0}, -degrees * kPi / 180));
  add_block(&scene, {0.2f, 0, 0.2f}, {1.1f, 0.8f, 0.9f}, door);
  add_panel(&scene, {4.2f, 2.45f, 1.6f}, 0.8f, 0.8f, lamp);
  add_camera(&scene, {0.3f, 1.5f, 3.7f}, {2.6f, 1, 0.9f});
  return scene;
}

/// An L-shaped corridor, 1.4 m wide and 2.5 m high; the lamp hangs round the corner.
inline scene::Scene corridor(Winding winding) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f}, {}, true);
  const int lamp = add_material(&scene, {0.5f, 0.5f, 0.5f}, {12, 11, 10}, true);
  constexpr float kWide = 1.4f, kLong = 6, kHigh = 2.5f;
  scene::Mesh walls;
  walls.material = white;
  const auto wall = [&](const Vec3& corner, const Vec3& a, const Vec3& b, const Vec3& inwards) {
    const bool faces_in = dot(cross(a, b), inwards) > 0;
    const bool keep = faces_in == (winding == Winding::Inwards);
    append_quad(&walls, corner, keep ? a : b, keep ? b : a);
  };
  const Vec3 up{0, kHigh, 0};
  wall({0, 0, 0}, {kLong, 0, 0}, up, {0, 0, 1});
  wall({0, 0, 0}, {0, 0, kLong}, up, {1, 0, 0});
  wall({kLong, 0, 0}, {0, 0, kWide}, up, {-1, 0, 0});
  wall({0, 0, kLong}, {kWide, 0, 0}, up, {0, 0, -1});
  wall({kWide, 0, kWide}, {kLong - kWide, 0, 0}, up, {0, 0, -1});
  wall({kWide, 0, kWide}, {0, 0, kLong - kWide}, up, {-1, 0, 0});
  for (const float y : {0.0f, kHigh}) {
    const Vec3 inwards{0, y > 0 ? -1.0f : 1.0f, 0};
    wall({0, y, 0}, {kLong, 0, 0}, {0, 0, kWide}, inwards);
    wall({0, y, kWide}, {kWide, 0, 0}, {0, 0, kLong - kWide}, inwards);
  }
  add_instance(&scene, std::move(walls));
  add_panel(&scene, {4.6f, 2.45f, 0.5f}, 0.6f, 0.4f, lamp);
  add_camera(&scene, {0.5f, 1.5f, 5.6f}, {0.7f, 1.2f, 0});
  return scene;
}

/// A shelf of five boards full of small things before the wall of a room with a two-sided panel.
inline scene::Scene shelves() {
  scene::Scene scene = panel_room(true);
  scene.cameras.clear();
  const int board = add_material(&scene, {0.55f, 0.45f, 0.35f}, {}, true);
  const int thing = add_material(&scene, {0.6f, 0.2f, 0.15f}, {}, true);
  const int other = add_material(&scene, {0.2f, 0.4f, 0.6f}, {}, true);
  for (int k = 0; k < 6; ++k) {
    const float y = 0.05f + 0.38f * static_cast<float>(k);
    add_block(&scene, {1.4f, y, 0.02f}, {3.8f, y + 0.03f, 0.36f}, board);
    if (k == 5) break;
    for (int i = 0; i < 14; ++i) {
      const float x = 1.45f + 0.165f * static_cast<float>(i);
      const float wide = 0.04f + 0.02f * static_cast<float>((i * 7 + k * 3) % 5);
      const float high = 0.12f + 0.04f * static_cast<float>((i * 5 + k * 11) % 6);
      const float back = 0.04f + 0.03f * static_cast<float>((i * 3 + k) % 4);
      add_block(&scene, {x, y + 0.031f, back}, {x + wide, y + 0.031f + high, back + 0.18f},
                (i + k) % 2 ? thing : other);
    }
  }
  for (const float x : {1.38f, 3.8f})
    add_block(&scene, {x, 0, 0.02f}, {x + 0.02f, 2.1f, 0.36f}, board);
  add_camera(&scene, {2.4f, 1.5f, 3.3f}, {2.5f, 1.1f, 0}, 60);
  return scene;
}

/// Spheres of 2 cm that shine, each in a cup that opens downwards, under the ceiling.
inline scene::Scene cups(float sphere_radius = 0.02f) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.75f, 0.75f, 0.75f}, {}, true);
  const int metal = add_material(&scene, {0.8f, 0.78f, 0.7f}, {}, true);
  const float power = 30.0f * 0.02f * 0.02f / (sphere_radius * sphere_radius);
  const int lamp =
      add_material(&scene, {0.5f, 0.5f, 0.5f}, {40 * power, 36 * power, 30 * power}, true);
  add_room(&scene, {0, 0, 0}, {4, 2.6f, 4}, white);
  add_block(&scene, {0.4f, 0, 0.5f}, {1.2f, 0.9f, 1.2f}, metal);
  for (const Vec3& at : {Vec3{1, 2.5f, 1}, Vec3{3, 2.5f, 1}, Vec3{1, 2.5f, 3}, Vec3{3, 2.5f, 3}}) {
    scene::Mesh cup;
    cup.material = metal;
    constexpr int kSides = 16;
    constexpr float kRadius = 0.06f, kDeep = 0.1f;
    for (int i = 0; i < kSides; ++i) {
      const auto rim = [&](int k) {
        const float angle = 2 * kPi * static_cast<float>(k) / kSides;
        return Vec3{kRadius * std::cos(angle), 0, kRadius * std::sin(angle)};
      };
      append_quad(&cup, rim(i), rim(i + 1) - rim(i), {0, kDeep, 0});
      const auto first = static_cast<uint32_t>(cup.positions.size());
      for (const Vec3& p : {rim(i), rim(i + 1), Vec3{}}) {
        cup.positions.push_back(p + Vec3{0, kDeep, 0});
        cup.uvs[0].push_back({});
      }
      cup.triangles.push_back({first, first + 1, first + 2});
    }
    add_instance(&scene, std::move(cup), translation(at + Vec3{0, -0.05f, 0}));
    scene::Mesh ball = inward_sphere_mesh(sphere_radius, 2, lamp);
    for (auto& triangle : ball.triangles) std::swap(triangle[0], triangle[1]);
    add_instance(&scene, std::move(ball), translation(at));
  }
  add_camera(&scene, {3.7f, 1.6f, 3.7f}, {1, 1, 0.8f});
  return scene;
}

/// A hall with 64 small lamps that hang close under its ceiling and light it from below.
inline scene::Scene small_lamps() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f}, {}, true);
  const int lamp = add_material(&scene, {}, {40, 40, 40}, true);
  add_room(&scene, {0, 0, 0}, {8, 3, 8}, white);
  add_block(&scene, {3, 0, 3}, {5, 0.9f, 5}, white);
  for (int i = 0; i < 64; ++i) {
    const auto x = static_cast<float>(i % 8) + 0.46f, z = static_cast<float>(i / 8) + 0.46f;
    add_panel(&scene, {x, 2.95f, z}, 0.08f, 0.08f, lamp);
  }
  add_camera(&scene, {7.5f, 1.6f, 7.5f}, {2, 1.2f, 2});
  return scene;
}

/// A box without a front: light that leaves is lost.
inline scene::Scene open_front() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.75f, 0.75f, 0.75f}, {}, true);
  const int red = add_material(&scene, {0.6f, 0.1f, 0.08f}, {}, true);
  const int lamp = add_material(&scene, {0.5f, 0.5f, 0.5f}, {12, 11, 9}, true);
  const auto quad = [&](const Vec3& corner, const Vec3& a, const Vec3& b, int m) {
    add_quad(&scene, corner, a, b, m);
  };
  quad({0, 0, 0}, {0, 0, 3}, {3, 0, 0}, white);
  quad({0, 2.5f, 0}, {3, 0, 0}, {0, 0, 3}, white);
  quad({0, 0, 0}, {3, 0, 0}, {0, 2.5f, 0}, white);
  quad({0, 0, 0}, {0, 2.5f, 0}, {0, 0, 3}, red);
  quad({3, 0, 0}, {0, 0, 3}, {0, 2.5f, 0}, white);
  add_block(&scene, {0.7f, 0, 0.6f}, {1.5f, 1.2f, 1.3f}, white);
  add_panel(&scene, {1.1f, 2.45f, 1.1f}, 0.8f, 0.8f, lamp);
  add_camera(&scene, {1.5f, 1.25f, 4.2f}, {1.5f, 1.2f, 0}, 50);
  return scene;
}

/// A gallery of albedo 0.9 with columns, 12 m long, lit by lamps behind a ledge under the ceiling.
inline scene::Scene gallery(float albedo = 0.9f) {
  scene::Scene scene;
  const int white = add_material(&scene, {albedo, albedo, albedo}, {}, true);
  const int lamp = add_material(&scene, {0.3f, 0.3f, 0.3f}, {10, 9, 8}, true);
  add_room(&scene, {0, 0, 0}, {12, 3.2f, 4}, white, Winding::Outwards);
  for (int i = 0; i < 5; ++i) {
    const float x = 1.5f + 2.2f * static_cast<float>(i);
    add_block(&scene, {x, 0, 2.6f}, {x + 0.3f, 3.2f, 2.9f}, white);
  }
  add_quad(&scene, {0, 2.8f, 0.35f}, {12, 0, 0}, {0, 0.2f, 0}, white);
  add_quad(&scene, {0, 2.8f, 0}, {12, 0, 0}, {0, 0, 0.35f}, white);
  for (int i = 0; i < 4; ++i)
    add_panel(&scene, {1 + 3 * static_cast<float>(i), 2.85f, 0.1f}, 1, 0.1f, lamp);
  add_camera(&scene, {0.5f, 1.6f, 3.6f}, {7, 1.4f, 1});
  return scene;
}

/// A room whose only light is the sun through a window with bars.
inline scene::Scene sun_through_bars() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.68f, 0.65f}, {}, true);
  const int dark = add_material(&scene, {0.2f, 0.2f, 0.2f}, {}, true);
  const auto quad = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
    add_quad(&scene, corner, a, b, white);
  };
  quad({0, 0, 0}, {0, 0, 5}, {4, 0, 0});
  quad({0, 2.8f, 0}, {4, 0, 0}, {0, 0, 5});
  quad({0, 0, 0}, {4, 0, 0}, {0, 2.8f, 0});
  quad({0, 0, 5}, {0, 2.8f, 0}, {4, 0, 0});
  quad({4, 0, 0}, {0, 0, 5}, {0, 2.8f, 0});
  // The wall at x = 0 has an opening, z in [2, 2.8], y in [1.2, 2.2].
  quad({0, 0, 0}, {0, 2.8f, 0}, {0, 0, 2});
  quad({0, 0, 2.8f}, {0, 2.8f, 0}, {0, 0, 2.2f});
  quad({0, 0, 2}, {0, 1.2f, 0}, {0, 0, 0.8f});
  quad({0, 2.2f, 2}, {0, 0.6f, 0}, {0, 0, 0.8f});
  for (int i = 0; i < 6; ++i) {
    const float z = 2.07f + 0.12f * static_cast<float>(i);
    add_block(&scene, {-0.06f, 1.2f, z}, {-0.02f, 2.2f, z + 0.05f}, dark);
  }
  add_block(&scene, {2.6f, 0, 0.6f}, {3.4f, 0.8f, 1.4f}, dark);
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.kind = scene::LightKind::Directional;
  sun.direction = normalize({1, -0.9f, -0.25f});
  sun.intensity = {60, 56, 50};
  sun.light_group = 0;
  scene.light_groups.push_back("sun");
  scene.lights.push_back(sun);
  add_camera(&scene, {3.6f, 1.6f, 4.6f}, {1, 1, 1.5f});
  return scene;
}

/// A dark gallery: albedo 0.08, spots of light.
inline scene::Scene dark_room() {
  scene::Scene scene = panel_room(true);
  scene.materials[0].base_color = {0.08f, 0.08f, 0.08f};
  scene.materials[1].base_color = {0.05f, 0.04f, 0.03f};
  return scene;
}

/// Every wall shines and reflects.
inline scene::Scene furnace() {
  scene::Scene scene;
  const int wall = add_material(&scene, {0.6f, 0.6f, 0.6f}, {1, 1, 1}, true);
  add_room(&scene, {0, 0, 0}, {4, 2.6f, 4}, wall);
  add_camera(&scene, {3.7f, 1.6f, 3.7f}, {1, 1, 0.8f});
  return scene;
}

}  // namespace lte::test
