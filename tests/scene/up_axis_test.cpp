// Scenes whose Z points up.
#include "lte/scene/up_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using ::testing::HasSubstr;

Scene standing_on_z() {
  Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 2, 3}, white, false),
                     test::translation({10, 20, 30}));
  test::add_point_light(&scene, {1, 2, 3}, {1, 1, 1});
  scene.lights[0].direction = {0, 0, -1};
  scene.cameras.push_back({"eye", {4, 5, 6}, {0, 0, 1}, {0, 0, 1}});
  scene.environment = Environment{};
  return scene;
}

TEST(UpAxis, TurnsEverythingSoThatZIsUp) {
  Scene scene = standing_on_z();
  const Vec3 seen = scene.cameras[0].direction(0.2f, 0.7f, 1.5f);
  turn_z_up(&scene);
  const Bounds bounds = scene.bounds();
  EXPECT_EQ(bounds.low, (Vec3{10, 30, -22}));
  EXPECT_EQ(bounds.high, (Vec3{11, 33, -20}));
  EXPECT_EQ(scene.lights[0].position, (Vec3{1, 3, -2}));
  EXPECT_EQ(scene.lights[0].direction, (Vec3{0, -1, 0})) << "down";
  EXPECT_GT(scene.instances[0].to_world.determinant(), 0) << "fronts stay fronts";
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.origin, (Vec3{4, 6, -5}));
  EXPECT_EQ(camera.up, (Vec3{0, 1, 0}));
  const Vec3 now = camera.direction(0.2f, 0.7f, 1.5f);
  EXPECT_NEAR(now.x, seen.x, 1e-6);
  EXPECT_NEAR(now.y, seen.z, 1e-6);
  EXPECT_NEAR(now.z, -seen.y, 1e-6);
  // The ray meets the same place of the environment as before.
  const Vec3 local = scene.environment->to_local(now);
  EXPECT_NEAR(length(local - seen), 0, 1e-6);
}

TEST(UpAxis, IsYByTheSpecificationOfGltf) {
  Scene scene = standing_on_z();
  const Bounds before = scene.bounds();
  set_up_axis("y", "a.glb", &scene);
  set_up_axis("y", "a.obj", &scene);
  EXPECT_EQ(scene.bounds().low, before.low);
  for (const char* file : {"a.glb", "b/a.GLTF"})
    EXPECT_THAT(test::error_of([&] { set_up_axis("z", file, &scene); }), HasSubstr("Y up"));
  EXPECT_THAT(test::error_of([&] { set_up_axis("x", "a.obj", &scene); }), HasSubstr("y or z"));
  set_up_axis("z", "a.obj", &scene);
  EXPECT_EQ(scene.bounds().low.y, before.low.z);
}

}  // namespace
}  // namespace lte::scene
