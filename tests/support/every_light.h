// A scene for every kind of light: an open room with pockets that no light reaches, and what each
// light group's scene points must emit by a closed form.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/scenes.h"

namespace lte::test {

struct LitScene {
  std::string light;
  scene::Scene scene;
  /// Σ emission · area of the red channel over the points of each light group, W sr⁻¹: power over π
  /// for surfaces and local lights, E r² for a sun, L 4π r² for an environment of radiance L.
  std::vector<double> strength;
  double tolerance = 1e-5;  ///< relative; textured lamps are estimates
};

/// A room [0, 4] × [0, 2.5] × [0, 3] m, open at x = 4, with a box in a box over its floor: light
/// reaches neither side of the inner one, [1.2, 2.8] × [0.3, 1.9] × [0.7, 2.3].
inline scene::Scene dark_room() {
  scene::Scene scene;
  scene.name = "room";
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh room = box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true);
  room.triangles.erase(room.triangles.begin() + 2, room.triangles.begin() + 4);
  add_instance(&scene, std::move(room));
  add_instance(&scene, box_mesh({1, 0.1f, 0.5f}, {3, 2.1f, 2.5f}, white, false));
  add_instance(&scene, box_mesh({1.2f, 0.3f, 0.7f}, {2.8f, 1.9f, 2.3f}, white, true));
  return scene;
}
inline constexpr double kHiddenArea = 6 * 1.6 * 1.6;
/// Floor, ceiling, three walls and the outer box.
inline constexpr double kReachedArea = 12 + 12 + 10 + 10 + 7.5 + 24;
/// Of the sphere around it.
inline double dark_room_radius() { return std::sqrt(16 + 6.25 + 9) / 2; }

inline void add_lamp(scene::Scene* scene, const Vec3& corner, float x, float z, const Rgb& radiance,
                     bool double_sided = false) {
  const int lamp = add_material(scene, {0, 0, 0}, radiance, double_sided);
  add_quad(scene, corner, {x, 0, 0}, {0, 0, z}, lamp);  // x × z = −y: down
}

/// Shines down, so that it does what a spot and a sun of its kind do.
inline scene::PunctualLight& add_punctual(scene::Scene* scene, scene::LightKind kind,
                                          const Rgb& intensity, const Vec3& at = {2, 2.3f, 1.5f}) {
  add_point_light(scene, at, intensity);
  scene->lights.back().kind = kind;
  scene->lights.back().direction = normalize(Vec3{-1, -1, 0});
  return scene->lights.back();
}

inline void add_sky(scene::Scene* scene, const Rgb& radiance) {
  scene->environment = scene::Environment();
  scene->environment->radiance = radiance;
  scene->environment->light_group = static_cast<int>(scene->light_groups.size());
  scene->light_groups.push_back("sky");
}

/// Each kind by itself, and then all together.
inline std::vector<LitScene> scenes_of_every_light() {
  using scene::LightKind;
  const double r2 = dark_room_radius() * dark_room_radius(), sphere = 4 * kPi * r2;
  std::vector<LitScene> out;
  const auto add = [&](const char* light, const auto& light_up, std::vector<double> strength,
                       double tolerance = 1e-5) {
    out.push_back({light, dark_room(), std::move(strength), tolerance});
    light_up(&out.back().scene);
  };
  add("lamp", [](auto* s) { add_lamp(s, {0.5f, 2.4f, 1}, 0.5f, 1, {8, 4, 2}); }, {8 * 0.5});
  add("two-sided lamp",
      [](auto* s) {
        add_lamp(s, {0.5f, 2.2f, 1}, 0.5f, 1, {8, 4, 2}, true);
      },
      {8 * 0.5 * 2});
  add("small lamp beside a large one",
      [](auto* s) {
        add_lamp(s, {0.5f, 2.4f, 0.2f}, 3, 2, {1, 1, 1});
        add_lamp(s, {3.7f, 2.4f, 2.7f}, 0.01f, 0.01f, {5000, 5000, 5000});
      },
      {6, 0.5});
  add(
      "textured lamp",  // a quarter of it shines
      [](auto* s) {
        add_lamp(s, {0.5f, 2.4f, 1}, 1, 1, {8, 4, 2});
        std::vector<uint8_t> texels(size_t{32} * 32 * 3, 0);
        for (size_t i = 0; i < 32 * 16; ++i)
          if (i % 32 < 16) std::fill_n(texels.begin() + static_cast<int64_t>(3 * i), 3, 255);
        s->textures.push_back(std::make_shared<const scene::Texture>(32, 32, texels, true));
        s->materials.back().emission_texture.texture = 0;
      },
      {8 * 0.25}, 0.15);
  add("point light", [](auto* s) { add_punctual(s, LightKind::Point, {3, 2, 1}); }, {12});
  add("spot",
      [](auto* s) {
        scene::PunctualLight& spot = add_punctual(s, LightKind::Spot, {3, 2, 1});
        spot.inner_cone = spot.outer_cone = kPi / 3;  // 2π (1 − cos 60°) sr
      },
      {3});
  add("sun", [](auto* s) { add_punctual(s, LightKind::Directional, {5, 4, 3}); }, {5 * r2});
  add("sky", [](auto* s) { add_sky(s, {2, 2, 3}); }, {2 * sphere});
  add("all together",
      [](auto* s) {
        add_lamp(s, {0.5f, 2.4f, 1}, 0.5f, 1, {8, 4, 2});
        add_punctual(s, LightKind::Point, {3, 2, 1});
        add_punctual(s, LightKind::Directional, {5, 4, 3});
        add_sky(s, {2, 2, 3});
        add_punctual(s, LightKind::Point, {1, 1, 1}, {0.2f, 0.2f, 0.2f});
      },
      {8 * 0.5, 12, 5 * r2, 2 * sphere, 4});
  return out;
}

/// Σ emission · area of the red channel by light group.
template <typename Samples>
std::vector<double> strengths(const Samples& samples, size_t groups) {
  std::vector<double> out(groups, 0.0);
  for (size_t i = 0; i < samples.position.size(); ++i) {
    if (samples.light_group[i] == scene::kNone) continue;
    out[static_cast<size_t>(samples.light_group[i])] +=
        double{samples.emission[i].x} * samples.area[i];
  }
  return out;
}

}  // namespace lte::test
