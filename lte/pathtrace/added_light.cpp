#include "lte/pathtrace/added_light.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/pathtrace/auto_camera.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/free_space.h"
#include "lte/scene/import/environment_file.h"

namespace lte::pathtrace {
namespace {

constexpr int kCandidates = 1024;
constexpr size_t kMostPanels = 64;
constexpr float kRoomHeight = 2.5f;  ///< metres; lower scenes are scale models of such a room
constexpr float kPanelSide = 0.3f, kPanelGap = 0.02f;
constexpr float kWattsPerSquareMetre = 10;

/// A place at eye height in a room.
struct Place {
  Vec3 eye;
  float free_distance = 0;  ///< geometric mean of the distances around it
};

/// A panel's square, below a ceiling.
struct Panel {
  Vec3 center;
  float side = 0, floor_area = 0;
};

/// Fills `free_distance`; false for a place in the open or inside a solid.
bool is_enclosed(const Bvh& bvh, float far, Place* place) {
  int hits = 0, fronts = 0;
  float log_sum = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 direction = probe_direction(i);
    const Hit hit = bvh.intersect({place->eye, direction});
    hits += hit.valid() ? 1 : 0;
    fronts += hit.valid() && dot(hit.normal, direction) < 0 ? 1 : 0;
    log_sum += std::log(std::max(hit.valid() ? hit.t : far, 1e-4f * far));
  }
  place->free_distance = std::exp(log_sum / kProbes);
  return static_cast<float>(hits) >= kEnclosed * kProbes &&
         static_cast<float>(fronts) >= kFronts * static_cast<float>(hits);
}

/// Enclosed places at eye height above floors, the widest first.
std::vector<Place> find_places(const Bvh& bvh) {
  const Bounds& bounds = bvh.bounds();
  const Vec3 extent = bounds.extent();
  const float unit = std::min(1.0f, extent.y / kRoomHeight), far = length(extent);
  std::vector<Place> places;
  if (!(unit > 0)) return places;
  Rng rng(0, 0x1a3b);
  for (int i = 0; i < kCandidates; ++i) {
    const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
    const Vec3 start = bounds.low + Vec3{x * extent.x, y * extent.y, z * extent.z};
    const float height = rng.uniform(1.2f, 1.7f) * unit;
    const Hit floor = bvh.intersect({start, {0, -1, 0}});
    if (!floor.valid() || std::abs(floor.normal.y) < 0.7f) continue;
    if (floor.t < height && bvh.occluded({start, {0, 1, 0}, 0, height - floor.t})) continue;
    Place place{start + Vec3{0, height - floor.t, 0}};
    if (is_enclosed(bvh, far, &place)) places.push_back(place);
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.free_distance > b.free_distance; });
  return places;
}

/// The middle between what lies to both sides along an axis, and the distance of the two.
float centre_between(const Bvh& bvh, const Vec3& from, int axis, float far, Vec3* middle) {
  Vec3 along{};
  along[axis] = 1;
  const Hit ahead = bvh.intersect({from, along}), behind = bvh.intersect({from, -along});
  const float a = ahead.valid() ? ahead.t : far, b = behind.valid() ? behind.t : far;
  (*middle)[axis] += (a - b) / 2;
  return a + b;
}

/// The panel of the room that has this place, if there is a ceiling above it.
std::optional<Panel> hang_panel(const Bvh& bvh, const Place& place) {
  const Hit above = bvh.intersect({place.eye, {0, 1, 0}}),
            below = bvh.intersect({place.eye, {0, -1, 0}});
  if (!above.valid() || !below.valid()) return std::nullopt;
  const float gap = kPanelGap * (above.t + below.t);
  const Vec3 under = place.eye + Vec3{0, std::max(above.t - gap, above.t / 2), 0};
  const float far = length(bvh.bounds().extent());
  Panel panel{under};
  const float x = centre_between(bvh, under, 0, far, &panel.center);
  const float z = centre_between(bvh, under, 2, far, &panel.center);
  panel.side = kPanelSide * std::min(x, z);
  panel.floor_area = x * z;
  // In the middle the ceiling may hang lower, or the middle may not be in the room at all.
  const Vec3 seen = panel.center - place.eye;
  const float distance = length(seen);
  if (distance > 0 && bvh.occluded({place.eye, seen / distance, 0, distance})) panel.center = under;
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

bool sees(const Bvh& bvh, const Place& place, const Panel& panel) {
  const Vec3 way = panel.center - place.eye;
  const float distance = length(way);
  return distance == 0 || !bvh.occluded({place.eye, way / distance, 0, distance * 0.9999f});
}

/// Whether anybody would stand in the scene, as the automatic camera judges: the hollow parts of an
/// object are enclosed as well.
bool has_rooms(const Bvh& bvh) {
  if (bvh.bounds().empty()) return false;
  const FreeSpace space = survey(bvh);
  return open_side_view(bvh, space, 1) || inside_view(bvh, space, 0);
}

std::vector<Panel> find_panels(const scene::Scene& scene) {
  const Bvh bvh(scene);
  std::vector<Panel> panels;
  if (!has_rooms(bvh)) return panels;
  for (const Place& place : find_places(bvh)) {
    if (panels.size() == kMostPanels) break;
    const bool lit = std::any_of(panels.begin(), panels.end(),
                                 [&](const Panel& panel) { return sees(bvh, place, panel); });
    if (lit) continue;
    if (const std::optional<Panel> panel = hang_panel(bvh, place)) panels.push_back(*panel);
  }
  return panels;
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

std::string add_panels(scene::Scene* scene) {
  const std::vector<Panel> panels = find_panels(*scene);
  if (panels.empty()) {
    if (scene->environment) return "nothing: there is no room, and the scene has an environment";
    scene::set_environment("1,1,1", 0, scene);
    return "an environment of radiance 1, as there is no room";
  }
  std::string text;
  for (const Panel& panel : panels) {
    add_panel(panel, scene);
    text += formatted("%sa panel of %.3g x %.3g m and %.3g W at %.3g %.3g %.3g",
                      text.empty() ? "" : "; ", panel.side, panel.side, panel_watts(panel),
                      panel.center.x, panel.center.y, panel.center.z);
  }
  return text;
}

std::optional<std::array<float, 4>> parse_numbers(const std::string& text) {
  std::array<float, 4> out{};
  const char *at = text.data(), *end = text.data() + text.size();
  for (size_t i = 0; i < out.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc() || !std::isfinite(out[i])) return std::nullopt;
    if (i == 3) return next == end ? std::optional(out) : std::nullopt;
    if (next == end || *next != ',') return std::nullopt;
    at = next + 1;
  }
  return std::nullopt;
}

}  // namespace

std::string add_light(const std::string& text, scene::Scene* scene) {
  if (text == "auto") return add_panels(scene);
  const std::optional<std::array<float, 4>> numbers = parse_numbers(text);
  LTE_CHECK(numbers, "added light \"", text,
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
