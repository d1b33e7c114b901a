#include "lte/scene/light_gains.h"

#include <gtest/gtest.h>

#include "lte/scene/luminaire_power.h"
#include "tests/support/message_of.h"

namespace lte::scene {
namespace {

/// Two squares of one mesh, a point light and a sky: four groups.
Scene four_lights() {
  Scene scene;
  Material lamp;
  lamp.name = "lamp";
  lamp.emission = {4, 2, 1};
  scene.materials = {lamp};
  Mesh square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes = {square};
  scene.instances = {{0, Affine(), 0}, {0, Affine(), 1}};
  PunctualLight bulb;
  bulb.intensity = {1, 1, 1};
  bulb.light_group = 2;
  scene.lights = {bulb};
  scene.environment.emplace();
  scene.environment->radiance = {1, 2, 3};
  scene.environment->light_group = 3;
  scene.light_groups = {"left", "right", "bulb", "sky"};
  return scene;
}

TEST(LightGains, ScaleThePowerOfEachGroup) {
  const Scene scene = four_lights();
  const std::vector<float> gains{0.5f, 1, 3, 0.25f};
  std::vector<int> trees;
  const Scene dimmed = with_gains(scene, gains, &trees);
  const std::vector<Rgb> before = luminaire_powers(scene), after = luminaire_powers(dimmed);
  for (size_t g = 0; g < 3; ++g) {
    EXPECT_GT(before[g].x, 0);
    for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(after[g][c], gains[g] * before[g][c]);
  }
  EXPECT_EQ(dimmed.environment->radiance, (Rgb{0.25f, 0.5f, 0.75f}));
  EXPECT_EQ(dimmed.light_groups, scene.light_groups);
  ASSERT_EQ(trees.size(), dimmed.meshes.size());
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const int mesh = dimmed.instances[i].mesh;
    EXPECT_EQ(trees[static_cast<size_t>(mesh)], scene.instances[i].mesh);
    EXPECT_EQ(dimmed.instances[i].light_group, scene.instances[i].light_group);
  }
}

TEST(LightGains, OfNothingLeaveNoLight) {
  std::vector<int> trees;
  const Scene dark = with_gains(four_lights(), std::vector<float>(4), &trees);
  EXPECT_TRUE(dark.lights.empty());
  EXPECT_FALSE(dark.environment);
  for (const Instance& instance : dark.instances) {
    const Mesh& mesh = dark.meshes[static_cast<size_t>(instance.mesh)];
    EXPECT_FALSE(dark.materials[static_cast<size_t>(mesh.material)].emissive());
    EXPECT_EQ(instance.light_group, kNone);
  }
  EXPECT_EQ(dark.light_groups.size(), 4u);
}

TEST(LightGains, AreCheckedByName) {
  const Scene scene = four_lights();
  std::vector<int> trees;
  const auto refusal = [&](const std::vector<float>& gains) {
    return test::message_of([&] { with_gains(scene, gains, &trees); });
  };
  EXPECT_NE(refusal({1, 1}).find("expected 4, one a light, got 2"), std::string::npos);
  EXPECT_NE(refusal({1, -1, 1, 1}).find("\"right\""), std::string::npos);
  EXPECT_NE(refusal({1, 1, 1, INFINITY}).find("\"sky\""), std::string::npos);
  EXPECT_NE(refusal({3e38f, 1, 1, 1}).find("\"left\": gain 3e+38 makes its light infinite"),
            std::string::npos);
}

}  // namespace
}  // namespace lte::scene
