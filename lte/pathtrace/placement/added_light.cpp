#include "lte/pathtrace/placement/added_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/base/to_number.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/placement/free_space.h"
#include "lte/pathtrace/placement/room_places.h"
#include "lte/scene/import/environment_file.h"

namespace lte::pathtrace {
namespace {

constexpr int kEnoughPlaces = 256;  ///< so that a cupboard of 1 % of a house has some
constexpr size_t kMaxPanels = 64;
constexpr float kPanelSide = 0.3f, kPanelGap = 0.02f;
constexpr float kWattsPerSquareMetre = 10;
/// Of a room's height: what is open to a side counts as so far, or as far as the scene reaches.
constexpr float kOpenSide = 2;
/// Of an open box's height: above what stands in it.
constexpr float kUpInABox = 0.8f;

/// A panel's square, below a ceiling.
struct Panel {
  Vec3 center;
  float side = 0, floor_area = 0;
};

/// The middle between what lies to both sides along an axis, and the distance of the two.
float centre_between(const Bvh& bvh, const Vec3& from, int axis, float open, Vec3* middle) {
  Vec3 along{};
  along[axis] = 1;
  const Hit ahead = bvh.intersect({from, along}), behind = bvh.intersect({from, -along});
  const Bounds& bounds = bvh.bounds();
  const float a = ahead.valid() ? ahead.t : std::min(open, bounds.high[axis] - from[axis]);
  const float b = behind.valid() ? behind.t : std::min(open, from[axis] - bounds.low[axis]);
  (*middle)[axis] += (a - b) / 2;
  return a + b;
}

/// Whether nothing stands between two points.
bool sees(const Bvh& bvh, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const float distance = length(way);
  return distance == 0 || !bvh.occluded({from, way / distance, 0, distance * 0.9999f});
}

/// The panel of the room around `eye`, if that has a floor, a ceiling and a room's height.
std::optional<Panel> hang_panel(const Bvh& bvh, const Vec3& eye, float lowest) {
  const Hit above = bvh.intersect({eye, {0, 1, 0}}), below = bvh.intersect({eye, {0, -1, 0}});
  if (!above.valid() || !below.valid()) return std::nullopt;
  const float height = above.t + below.t;
  if (height < lowest) return std::nullopt;
  const float gap = kPanelGap * height;
  const Vec3 under = eye + Vec3{0, std::max(above.t - gap, above.t / 2), 0};
  Panel panel{under};
  const float x = centre_between(bvh, under, 0, kOpenSide * height, &panel.center);
  const float z = centre_between(bvh, under, 2, kOpenSide * height, &panel.center);
  panel.side = kPanelSide * std::min(x, z);
  panel.floor_area = x * z;
  // In the middle the ceiling may hang lower, or the middle may not be in the room at all.
  if (!sees(bvh, eye, panel.center)) panel.center = under;
  const Hit ceiling = bvh.intersect({panel.center, {0, 1, 0}});
  if (!ceiling.valid() || ceiling.t > 2 * gap) panel.center = under;
  const float half = std::min({std::abs(panel.center.x - bvh.bounds().low.x),
                               std::abs(panel.center.x - bvh.bounds().high.x),
                               std::abs(panel.center.z - bvh.bounds().low.z),
                               std::abs(panel.center.z - bvh.bounds().high.z)});
  panel.side = std::min(panel.side, 1.8f * half);
  if (!(panel.side > 0)) return std::nullopt;
  return panel;
}

/// What "auto" adds.
struct Choice {
  std::vector<Panel> panels;
  bool environment = false;
};

/// Panels where the cameras stand, if that is in rooms, and an environment for those outside.
/// Before an open box they stand outside, and see its inside.
Choice choose_lights(const scene::Scene& scene, std::span<const scene::Camera> cameras) {
  const Bvh bvh(scene);
  Choice out{{}, true};
  if (bvh.bounds().empty()) return out;
  const FreeSpace space = survey(bvh);
  std::vector<Vec3> inside;
  for (const scene::Camera& camera : cameras)
    if (is_enclosed(bvh, camera.origin)) inside.push_back(camera.origin);
  const bool open_box = open_side_view(bvh, space, 1).has_value();
  if (!cameras.empty() && inside.empty() && !open_box) return out;

  const auto add = [&](const Vec3& eye, float lowest) {
    if (out.panels.size() == kMaxPanels) return;
    for (const Panel& panel : out.panels)
      if (sees(bvh, eye, panel.center)) return;
    if (const std::optional<Panel> panel = hang_panel(bvh, eye, lowest))
      out.panels.push_back(*panel);
  };
  std::vector<RoomPlace> places = find_room_places(bvh, space, 0, kEnoughPlaces);
  std::sort(places.begin(), places.end(), [](const RoomPlace& a, const RoomPlace& b) {
    return a.free_distance > b.free_distance;
  });
  for (const RoomPlace& place : places) add(place.eye, kLowestRoom * space.unit);
  for (const Vec3& eye : inside) add(eye, 0);  // which may be in no room
  if (open_box) {                              // nor is a box that is lower than one
    const Bounds& box = bvh.bounds();
    add({box.center().x, box.low.y + kUpInABox * box.extent().y, box.center().z}, 0);
  }
  out.environment = out.panels.empty() || (!open_box && inside.size() < cameras.size());
  return out;
}

float panel_watts(const Panel& panel) { return kWattsPerSquareMetre * panel.floor_area; }

void add_panel(const Panel& panel, scene::Scene* scene) {
  scene::Material material;
  material.name = concat("added light ", scene->light_groups.size());
  material.base_color = {0, 0, 0};
  const float radiance = panel_watts(panel) / (kPi * panel.side * panel.side);
  material.emission = {radiance, radiance, radiance};
  scene::Mesh mesh;
  mesh.name = material.name;
  mesh.material = static_cast<int>(scene->materials.size());
  const float h = panel.side / 2;
  for (const Vec3& corner : {Vec3{-h, 0, -h}, Vec3{h, 0, -h}, Vec3{h, 0, h}, Vec3{-h, 0, h}})
    mesh.positions.push_back(panel.center + corner);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};  // fronts look down
  scene->instances.push_back({static_cast<int>(scene->meshes.size()), Affine(),
                              static_cast<int>(scene->light_groups.size())});
  scene->light_groups.push_back(material.name);
  scene->materials.push_back(std::move(material));
  scene->meshes.push_back(std::move(mesh));
}

std::string add_automatic(std::span<const scene::Camera> cameras, scene::Scene* scene) {
  const Choice choice = choose_lights(*scene, cameras);
  if (!scene->light_groups.empty())
    log_warning("--add-light auto: the scene has light already, ", scene->light_groups.size(),
                scene->light_groups.size() == 1 ? " luminaire" : " luminaires",
                "; what is added shines beside it, and either may outshine the other");
  std::string text;
  for (const Panel& panel : choice.panels) {
    add_panel(panel, scene);
    text += formatted("%sa panel of %.3g x %.3g m and %.3g W at %.3g %.3g %.3g",
                      text.empty() ? "" : "; ", panel.side, panel.side, panel_watts(panel),
                      panel.center.x, panel.center.y, panel.center.z);
  }
  if (!choice.environment) return text;
  const char* why = cameras.empty() ? "there is no room" : "it is seen from outside";
  if (scene->environment && !text.empty()) return text;
  if (scene->environment) return concat("nothing: ", why, ", and the scene has an environment");
  scene::set_environment("1,1,1", 0, scene);
  return concat(text, text.empty() ? "" : "; ", "an environment of radiance 1, as ", why);
}

}  // namespace

std::string add_light(const std::string& text, std::span<const scene::Camera> cameras,
                      scene::Scene* scene) {
  if (text == "auto") return add_automatic(cameras, scene);
  const auto numbers = to_numbers<float, 4>(text, ',');
  LTE_CHECK(numbers && std::ranges::all_of(*numbers, [](float v) { return std::isfinite(v); }),
            "added light \"", text,
            "\": expected auto, or x,y,z,power: four numbers, metres and watts");
  const auto [x, y, z, power] = *numbers;
  constexpr float kFarthest = 1e9f;
  LTE_CHECK(std::max({std::abs(x), std::abs(y), std::abs(z)}) <= kFarthest, "added light \"", text,
            "\": its place must lie within ", kFarthest, " m of the origin");
  LTE_CHECK(power > 0 && power <= 1e12f, "added light \"", text,
            "\": its power must be above 0 and at most 1e12 watts");
  scene::PunctualLight light;
  light.name = concat("added light ", scene->light_groups.size());
  light.position = {x, y, z};
  const float intensity = power / (4 * kPi);
  light.intensity = {intensity, intensity, intensity};
  light.light_group = static_cast<int>(scene->light_groups.size());
  scene->light_groups.push_back(light.name);
  scene->lights.push_back(std::move(light));
  return formatted("a point light of %.3g W at %.3g %.3g %.3g", power, x, y, z);
}

}  // namespace lte::pathtrace
