// Luminaires that are added to scenes.
#include "lte/pathtrace/placement/added_light.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"
#include "tests/support/machine.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Closed rooms in a row along x, each 4 x 2.5 x 3 m, without light.
scene::Scene dark_rooms(int count) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.8f, 0.8f, 0.8f});
  for (int i = 0; i < count; ++i) {
    const float x = 4.2f * static_cast<float>(i);
    test::add_instance(&scene, test::box_mesh({x, 0, 0}, {x + 4, 2.5f, 3}, white, true));
  }
  return scene;
}

Bounds bounds_of(const scene::Scene& scene, const scene::Instance& instance) {
  Bounds out;
  for (const Vec3& p : scene.meshes[static_cast<size_t>(instance.mesh)].positions)
    out.extend(instance.to_world.point(p));
  return out;
}

TEST(AddedLight, AutoHangsAPanelInTheMiddleOfTheCeilingOfEachRoom) {
  for (const int rooms : {1, 3}) {
    scene::Scene scene = dark_rooms(rooms);
    const std::string said = add_light("auto", &scene);
    EXPECT_THAT(said, HasSubstr("panel"));
    ASSERT_EQ(scene.instances.size(), static_cast<size_t>(2 * rooms)) << said;
    ASSERT_EQ(scene.light_groups.size(), static_cast<size_t>(rooms));
    std::vector<bool> lit(static_cast<size_t>(rooms));
    for (size_t i = static_cast<size_t>(rooms); i < scene.instances.size(); ++i) {
      const Bounds panel = bounds_of(scene, scene.instances[i]);
      const auto room = static_cast<size_t>(panel.center().x / 4.2f);
      ASSERT_LT(room, lit.size());
      EXPECT_FALSE(lit[room]) << "two panels in one room";
      lit[room] = true;
      EXPECT_NEAR(panel.center().x, 4.2f * static_cast<float>(room) + 2, 1e-3f);
      EXPECT_NEAR(panel.center().z, 1.5f, 1e-3f);
      EXPECT_NEAR(panel.center().y, 2.45f, 1e-3f) << "2 % of the height below the ceiling";
      EXPECT_NEAR(panel.extent().x, 0.9f, 1e-3f);
      EXPECT_NEAR(panel.extent().z, 0.9f, 1e-3f);
      const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
      const float radiance = scene.materials[static_cast<size_t>(mesh.material)].emission.x;
      EXPECT_NEAR(radiance * kPi * 0.81f, 10 * 12, 0.1) << "10 W for each of 12 m²";
    }
  }
}

TEST(AddedLight, ThePanelShinesDownOnTheFloor) {
  scene::Scene scene = dark_rooms(1);
  add_light("auto", &scene);
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{2, 0, 1.5f}, {2, 2.5f, 0.2f}}, normals{{0, 1, 0}, {0, -1, 0}};
  const Irradiance light = estimate_irradiance(bvh, lights, positions, normals, {});
  // Seen from so far off, the panel is nearly a point: E = I cosθ / r² with I = Φ / π.
  EXPECT_NEAR(light.direct_sum(0).x, 120 / kPi / (2.45f * 2.45f), 0.07 * 120 / kPi / 6);
  EXPECT_EQ(light.direct_sum(1).x, 0) << "it does not shine upwards";
  EXPECT_GT(light.indirect_sum(1).x, 0);
}

TEST(AddedLight, WhatNothingEnclosesGetsAnEnvironment) {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({-1, 0, -1}, {1, 2, 1}, gray, false));
  EXPECT_THAT(add_light("auto", &scene), HasSubstr("environment of radiance 1"));
  ASSERT_TRUE(scene.environment.has_value());
  EXPECT_EQ(scene.environment->radiance, (Rgb{1, 1, 1}));
  EXPECT_EQ(scene.light_groups.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(add_light("auto", &scene), HasSubstr("nothing"));
  EXPECT_EQ(scene.light_groups.size(), 1u);
}

TEST(AddedLight, AHollowObjectGetsAnEnvironmentAndNoPanelInside) {
  scene::Scene scene = test::vessel();
  EXPECT_THAT(add_light("auto", &scene), HasSubstr("environment of radiance 1"));
  EXPECT_TRUE(scene.environment.has_value());
}

scene::Camera camera_at(const Vec3& origin) {
  scene::Camera camera;
  camera.origin = origin;
  camera.target = {2, 1, 1};
  return camera;
}

TEST(AddedLight, IsWhereTheCamerasStand) {
  const scene::Camera within = camera_at({1, 1.5f, 1}), outside = camera_at({9, 4, 9});
  scene::Scene seen_from_outside = dark_rooms(1);
  EXPECT_EQ(add_light("auto", std::vector{outside}, &seen_from_outside),
            "an environment of radiance 1, as it is seen from outside");
  EXPECT_EQ(seen_from_outside.instances.size(), 1u) << "no panel";
  scene::Scene seen_from_within = dark_rooms(1);
  add_light("auto", std::vector{within}, &seen_from_within);
  EXPECT_EQ(seen_from_within.instances.size(), 2u);
  EXPECT_FALSE(seen_from_within.environment.has_value());
  scene::Scene from_both = dark_rooms(1);
  add_light("auto", std::vector{outside, within}, &from_both);
  EXPECT_EQ(from_both.instances.size(), 2u);
  EXPECT_TRUE(from_both.environment.has_value());
}

TEST(AddedLight, ABoxThatIsOpenToTheCameraHasItsPanelInside) {
  for (const float scale : {1.0f, 0.2f}) {  // Cornell's is lower than a room
    scene::Scene scene = dark_rooms(1);
    scene.meshes[0].triangles.resize(10);  // without the side towards +z
    scene.instances[0].to_world = test::scaling({scale, scale, scale});
    add_light("auto", std::vector{camera_at(Vec3{2, 1.2f, 9} * scale)}, &scene);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_FALSE(scene.environment.has_value());
    const Bounds panel = bounds_of(scene, scene.instances[1]);
    const Vec3 center = panel.center() / scale;
    EXPECT_NEAR(center.x, 2, 1e-3f);
    EXPECT_NEAR(center.y, 2.45f, 1e-2f);
    EXPECT_NEAR(center.z, 1.5f, 1e-3f) << "in the middle of the box, its open side included";
  }
}

TEST(AddedLight, ACameraInAHollowThatIsNoRoomHasAPanelThere) {
  scene::Scene scene = test::vessel();
  const std::string said = add_light("auto", std::vector{camera_at({5, -10, 3})}, &scene);
  EXPECT_THAT(said, HasSubstr("panel"));
  EXPECT_FALSE(scene.environment.has_value());
}

TEST(AddedLight, AMachineWithAFewHollowsIsNoHouse) {
  scene::Scene scene = test::machine();
  EXPECT_EQ(add_light("auto", &scene), "an environment of radiance 1, as there is no room");
  EXPECT_EQ(scene.light_groups.size(), 1u);
}

/// What hangs in the gap between two ceilings would light nobody.
TEST(AddedLight, HangsNoPanelWhereNobodyCouldStand) {
  scene::Scene scene = dark_rooms(1);
  const int white = 0;
  test::add_instance(&scene, test::box_mesh({0, 2.6f, 0}, {4, 3.4f, 3}, white, true));
  add_light("auto", &scene);
  ASSERT_EQ(scene.light_groups.size(), 1u);
  EXPECT_LT(bounds_of(scene, scene.instances.back()).high.y, 2.5f);
}

TEST(AddedLight, APointLightSendsItsWattsEvenly) {
  scene::Scene scene = dark_rooms(1);
  add_light("2,1.5,-1e0,50", &scene);
  add_light("1,1,1,8", &scene);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].position, (Vec3{2, 1.5f, -1}));
  EXPECT_NEAR(scene.lights[0].intensity.x * 4 * kPi, 50, 1e-4);
  EXPECT_EQ(scene.lights[1].light_group, 1);
  ASSERT_EQ(scene.light_groups.size(), 2u);
  EXPECT_NE(scene.light_groups[0], scene.light_groups[1]);
  EXPECT_EQ(Lights(scene).groups(), 2);
}

TEST(AddedLight, RefusesWhatIsNone) {
  scene::Scene scene = dark_rooms(1);
  for (const char* bad : {"", "auto ", "1,2,3", "1,2,3,4,5", "1,2,3,0", "1,2,3,-4", "1,2,3,nan",
                          "inf,2,3,4", "1;2;3;4", "1,2,3,1e30", "1e30,2,3,4", "1,2,,4"}) {
    EXPECT_THAT([&] { add_light(bad, &scene); },
                ThrowsMessage<Error>(HasSubstr(std::string("\"") + bad + "\"")))
        << bad;
  }
  EXPECT_TRUE(scene.lights.empty());
}

}  // namespace
}  // namespace lte::pathtrace
