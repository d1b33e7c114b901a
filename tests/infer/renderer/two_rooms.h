// Rooms under a sky, of whose light and of each other's none comes in: for tests of light that does
// not reach what is seen.
#pragma once

#include <utility>

#include "lte/scene/scene.h"
#include "tests/support/scenes.h"

namespace lte::test {

/// Two closed rooms side by side, 4 x 3 x 5 m each, a lamp under either ceiling, under a sky.
struct TwoRooms {
  int lamp = 0, other_lamp = 0, sky = 0;  ///< light groups
  scene::Scene scene;

  /// @param roof  whether the first room has one
  explicit TwoRooms(float sky_radiance = 1, bool roof = true) {
    const int wall = add_material(&scene, {0.6f, 0.5f, 0.4f}, {}, /*double_sided=*/true);
    lamp = add_room(0, wall, roof);
    other_lamp = add_room(10, wall, /*roof=*/true);
    scene.environment.emplace();
    scene.environment->radiance = {sky_radiance, sky_radiance, sky_radiance};
    sky = static_cast<int>(scene.light_groups.size());
    scene.environment->light_group = sky;
    scene.light_groups.push_back("the sky");
  }

  /// Closes the first room. @return  the instance of the lid
  int add_lid() {
    const int wall = add_material(&scene, {0.6f, 0.5f, 0.4f}, {}, /*double_sided=*/true);
    return add_quad(&scene, {-0.5f, 3, -0.5f}, {5, 0, 0}, {0, 0, 6}, wall);
  }

  /// Looks from one corner of the first room at the other.
  static scene::Camera inside() { return {"in", {0.3f, 1.5f, 0.3f}, {3, 1, 4}, {0, 1, 0}, 70}; }
  static scene::Camera outside() { return {"out", {2, 8, -9}, {5, 1, 2}, {0, 1, 0}, 60}; }

 private:
  int add_room(float x, int wall, bool roof) {
    scene::Mesh box = box_mesh({x, 0, 0}, {x + 4, 3, 5}, wall, /*inwards=*/true);
    if (!roof) box.triangles.erase(box.triangles.begin() + 6, box.triangles.begin() + 8);
    add_instance(&scene, std::move(box));
    const int shine = add_material(&scene, {}, {4, 4, 4});
    const int instance = add_quad(&scene, {x + 1.5f, 2.9f, 2}, {1, 0, 0}, {0, 0, 1}, shine);
    return scene.instances[static_cast<size_t>(instance)].light_group;
  }
};

}  // namespace lte::test
