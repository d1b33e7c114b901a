#include "experiments/stability/stress_scene.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lte::experiments {
namespace {

constexpr int kSliverStrips = 4096;
const Rgb kLampRadiance{15, 13, 10};

/// A parallelogram; its front is on the side of u × v.
struct Panel {
  Vec3 corner, u, v;

  float area() const { return length(cross(u, v)); }
};

/// The five faces of a box that are seen from outside when it stands on the floor, or the six of a
/// room from inside.
std::vector<Panel> box_panels(const Vec3& low, const Vec3& high, bool room) {
  const Vec3 e = high - low;
  const Vec3 x{e.x, 0, 0}, y{0, e.y, 0}, z{0, 0, e.z};
  std::vector<Panel> panels = {{low, y, z}, {low + x, z, y}, {low + y, x, z},
                               {low, x, y}, {low + z, y, x}, {low, z, x}};
  if (room) return panels;
  panels.pop_back();
  for (Panel& panel : panels) std::swap(panel.u, panel.v);
  return panels;
}

struct Part {
  Rgb albedo;
  std::vector<Panel> panels;
};

std::vector<Part> room_parts() {
  return {{{0.70F, 0.68F, 0.62F}, box_panels({0, 0, 0}, {6, 2.7F, 4}, true)},
          {{0.60F, 0.15F, 0.12F}, box_panels({0.3F, 0, 0.4F}, {1.2F, 1.9F, 1.0F}, false)},
          {{0.15F, 0.30F, 0.55F}, box_panels({2.4F, 0, 1.6F}, {3.9F, 0.75F, 2.5F}, false)},
          {{0.25F, 0.50F, 0.20F}, box_panels({4.6F, 0, 0.2F}, {5.8F, 1.2F, 1.3F}, false)},
          {{0.45F, 0.35F, 0.25F}, box_panels({1.0F, 0, 3.0F}, {2.2F, 0.45F, 3.8F}, false)}};
}

/// Adds the panel as columns x rows cells of two triangles.
void add_grid(const Panel& panel, int columns, int rows, bool degenerate, scene::Mesh* mesh) {
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  const auto pitch = static_cast<uint32_t>(columns + 1);
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh->positions.push_back(panel.corner +
                                panel.u * (static_cast<float>(i) / static_cast<float>(columns)) +
                                panel.v * (static_cast<float>(j) / static_cast<float>(rows)));
    }
  }
  for (uint32_t j = 0; j < static_cast<uint32_t>(rows); ++j) {
    for (uint32_t i = 0; i < static_cast<uint32_t>(columns); ++i) {
      const uint32_t a = first + j * pitch + i, b = a + 1, c = a + pitch, d = c + 1;
      mesh->triangles.push_back({a, b, d});
      if (degenerate) mesh->triangles.push_back({a, a, a});
      mesh->triangles.push_back({a, d, c});
      if (degenerate) mesh->triangles.push_back({a, d, a});
    }
  }
  if (!degenerate) return;
  // Three points in a line: the middle of an edge, where the far corners are.
  const auto middle = static_cast<uint32_t>(mesh->positions.size());
  mesh->positions.push_back(panel.corner + panel.u * 0.5F);
  mesh->triangles.push_back({first, middle, first + pitch - 1});
}

scene::Material matt(const std::string& name, const Rgb& albedo, const Rgb& emission) {
  scene::Material material;
  material.name = name;
  material.base_color = albedo;
  material.emission = emission;
  return material;
}

void place(scene::Mesh mesh, int group, scene::Scene* scene) {
  mesh.material = static_cast<int>(scene->materials.size()) - 1;
  scene->meshes.push_back(std::move(mesh));
  scene->instances.push_back({static_cast<int>(scene->meshes.size()) - 1, {}, group});
}

/// Cuts the lamp into a grid whose rows are the largest divisor up to the root.
void add_lamp(const StressRoom& room, scene::Scene* scene) {
  scene->materials.push_back(matt("lamp", {}, kLampRadiance * room.radiance));
  int rows = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(room.luminaires))));
  while (room.luminaires % rows != 0) --rows;
  const int columns = room.luminaires / rows;
  const Vec3 u{0.8F / static_cast<float>(columns), 0, 0}, v{0, 0, 0.6F / static_cast<float>(rows)};
  for (int k = 0; k < room.luminaires; ++k) {
    scene::Mesh mesh;
    mesh.name = "lamp";
    const Vec3 corner = Vec3{2.6F, 2.65F, 1.7F} + u * static_cast<float>(k % columns) +
                        v * static_cast<float>(k / columns);
    add_grid({corner, u, v}, 1, 1, false, &mesh);  // u × v looks down
    place(std::move(mesh), k, scene);
    scene->light_groups.push_back("lamp " + std::to_string(k));
  }
}

}  // namespace

scene::Scene make_stress_room(const StressRoom& room) {
  scene::Scene scene;
  scene.name = "room";
  const std::vector<Part> parts = room_parts();
  double area = 0;
  for (const Part& part : parts)
    for (const Panel& panel : part.panels) area += double{panel.area()};
  for (const Part& part : parts) {
    scene.materials.push_back(matt("matt", part.albedo, {}));
    scene::Mesh mesh;
    mesh.name = "surface";
    for (const Panel& panel : part.panels) {
      const double cells = 0.5 * static_cast<double>(room.triangles) * double{panel.area()} / area;
      const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(cells))));
      for (int copy = 0; copy < (room.coincident ? 2 : 1); ++copy)
        add_grid(panel, room.slivers ? kSliverStrips : side, room.slivers ? 1 : side,
                 room.degenerate, &mesh);
    }
    place(std::move(mesh), scene::kNone, &scene);
  }
  add_lamp(room, &scene);
  for (scene::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p = p * room.scale + room.offset;
  return scene;
}

}  // namespace lte::experiments
