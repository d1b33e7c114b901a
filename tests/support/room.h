// The furnished room with its BVH, lights, and a few points on floor, wall and box.
#pragma once

#include <vector>

#include "lte/pathtrace/irradiance.h"
#include "tests/support/scenes.h"

namespace lte::test {

struct Room {
  explicit Room(scene::Scene s = furnished_room())
      : scene(std::move(s)), bvh(scene), lights(scene) {}

  pathtrace::Irradiance estimate(const pathtrace::IrradianceOptions& options,
                                 int64_t first_index = 0) const {
    return pathtrace::estimate_irradiance(bvh, lights, positions, normals, options, first_index);
  }

  scene::Scene scene;
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
  std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}, {0.9f, 1.1f, 1}, {3.2f, 0, 0.4f}, {4, 2, 1}};
  std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {-1, 0, 0}};
};

}  // namespace lte::test
