#include "datagen/common/sides.h"

#include <gtest/gtest.h>

#include "datagen/dataset/generate.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

scene::Scene scene_of(const SideConfig& sides, uint64_t seed) {
  DatagenConfig config = tiny_config();
  config.sides = sides;
  return generate_scene(config, seed, "room");
}

int two_sided_lamps(const scene::Scene& scene) {
  int lamps = 0;
  for (const scene::Mesh& mesh : scene.meshes) {
    const scene::Material& material = scene.materials[static_cast<size_t>(mesh.material)];
    lamps += material.emissive() && material.double_sided ? 1 : 0;
  }
  return lamps;
}

TEST(Sides, LampsHangAndShineFromBothSidesInTheirShare) {
  int lamps = 0, two_sided = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const scene::Scene scene = scene_of({.two_sided_share = 0.5}, seed);
    const scene::Scene plain = scene_of({}, seed);
    EXPECT_EQ(two_sided_lamps(plain), 0);
    EXPECT_EQ(scene.meshes.size(), plain.meshes.size());
    lamps += static_cast<int>(scene.light_groups.size());
    two_sided += two_sided_lamps(scene);
    const float ceiling = plain.bounds().high.y;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
      if (!scene.materials[static_cast<size_t>(mesh.material)].double_sided) continue;
      const float height = scene.instances[i].to_world.point(mesh.positions[0]).y;
      EXPECT_LT(height, ceiling - 0.039f);
      EXPECT_GT(height, ceiling - 0.65f);
    }
  }
  EXPECT_NEAR(two_sided, 0.5 * lamps, 3 * std::sqrt(0.25 * lamps));
}

TEST(Sides, WindingsChangeNoLight) {
  const scene::Scene plain = scene_of({}, 3), flipped = scene_of({.flipped_share = 1}, 3);
  EXPECT_NE(plain.meshes[0].triangles, flipped.meshes[0].triangles);
  const std::vector<Vec3> positions{plain.bounds().center()}, normals{{0, 1, 0}};
  const auto light = [&](const scene::Scene& scene) {
    const pathtrace::Bvh bvh(scene);
    const pathtrace::Lights lights(scene);
    return pathtrace::estimate_irradiance(bvh, lights, positions, normals, {.rays = 65536})
        .total(0);
  };
  const Rgb a = light(plain), b = light(flipped);
  EXPECT_GT(a.y, 0);
  EXPECT_NEAR(b.y, a.y, 0.02f * a.y);
}

TEST(Sides, TheirKeysAreChecked) {
  DatagenConfig config = tiny_config();
  config.sides.two_sided_share = 1.5;
  EXPECT_THROW(check_datagen_config(config), Error);
  config.sides = {.flipped_share = 0.5};
  EXPECT_NO_THROW(check_datagen_config(config));
  EXPECT_NE(to_yaml(config).find("flipped_share: 0.5"), std::string::npos);
}

}  // namespace
}  // namespace lte::datagen::test
