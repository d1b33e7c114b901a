// Rooms with closed forms, for the tests of rendering.
#pragma once

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/render/integrator.h"
#include "tests/support/scenes.h"

namespace lte::test {

/// A box whose walls reflect `albedo` and emit `radiance`: irradiance is E = pi L / (1 - albedo)
/// everywhere, of which pi L is direct.
inline scene::Scene furnace(float albedo, float radiance) {
  scene::Scene scene;
  const int wall = add_material(&scene, {albedo, albedo, albedo}, {radiance, radiance, radiance});
  add_instance(&scene, box_mesh({0, 0, 0}, {2, 2, 2}, wall, /*inwards=*/true));
  return scene;
}

/// A floor that reflects `albedo` under a square panel of edge 2 and radiance L at height 1, both
/// centred: under its middle E = L pi times the form factor of the panel.
inline scene::Scene panel_over_floor(float albedo, float radiance) {
  scene::Scene scene;
  const int floor = add_material(&scene, {albedo, albedo, albedo});
  const int panel = add_material(&scene, {0, 0, 0}, {radiance, radiance, radiance});
  add_quad(&scene, {-20, 0, -20}, {0, 0, 40}, {40, 0, 0}, floor);
  add_quad(&scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, panel);
  return scene;
}

inline scene::Camera camera_from(const Vec3& origin, const Vec3& target, float vfov = 60) {
  scene::Camera camera;
  camera.name = "test";
  camera.origin = origin;
  camera.target = target;
  camera.vfov = vfov;
  return camera;
}

/// What rays are traced in.
struct Traced {
  explicit Traced(scene::Scene with) : scene(std::move(with)), bvh(scene), lights(scene) {}
  render::TracedScene view() const { return {bvh, lights}; }

  scene::Scene scene;
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
};

}  // namespace lte::test
