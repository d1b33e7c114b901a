#include "lte/pathtrace/placement/turntable.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/pathtrace/placement/auto_camera.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::pathtrace {
namespace {

scene::Scene object() {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({9, 0, 4}, {11, 2, 6}, gray, false));
  return scene;
}

/// Open towards +Z.
scene::Scene stage() {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 2}, {2, 0, 0}, gray);
  test::add_quad(&scene, {0, 2, 0}, {2, 0, 0}, {0, 0, 2}, gray);
  test::add_quad(&scene, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, gray);
  test::add_quad(&scene, {0, 0, 0}, {0, 2, 0}, {0, 0, 2}, gray);
  test::add_quad(&scene, {2, 0, 0}, {0, 0, 2}, {0, 2, 0}, gray);
  return scene;
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(Turntable, CirclesAnObjectFromOutside) {
  const scene::Scene scene = object();
  const Bvh bvh(scene);
  const scene::Camera first{"first", {10, 3, 9}, {10, 1, 5}, {0, 1, 0}, 40};
  const Turntable table = turntable(bvh, first, 4);
  EXPECT_EQ(table.turn, Turn::Around);
  ASSERT_EQ(table.cameras.size(), 4u);
  EXPECT_EQ(table.cameras[0].origin, first.origin) << "it begins with the camera as it stands";
  EXPECT_EQ(table.cameras[0].target, first.target);
  // Quarters of a turn about the middle of the box, (10, ·, 5), counter-clockwise from above.
  expect_near(table.cameras[1].origin, {14, 3, 5}, 1e-4f);
  expect_near(table.cameras[2].origin, {10, 3, 1}, 1e-4f);
  expect_near(table.cameras[3].origin, {6, 3, 5}, 1e-4f);
  for (const scene::Camera& camera : table.cameras) expect_near(camera.target, {10, 1, 5}, 1e-4f);
}

TEST(Turntable, TurnsInPlaceInsideARoom) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const scene::Camera first{"first", {2, 1.6f, 1.5f}, {3, 1.5f, 1.5f}, {0, 1, 0}, 60};
  const Turntable table = turntable(bvh, first, 6);
  EXPECT_EQ(table.turn, Turn::LookRound);
  Vec3 sum{};
  for (const scene::Camera& camera : table.cameras) {
    expect_near(camera.origin, first.origin, 1e-5f);
    const Vec3 view = camera.target - camera.origin;
    EXPECT_NEAR(view.y, -0.1f, 1e-5f) << "the pitch stays";
    sum += view;
  }
  expect_near({sum.x, 0, sum.z}, {}, 1e-4f);
}

TEST(Turntable, SwingsBeforeAnOpenBox) {
  const scene::Scene scene = stage();
  const Bvh bvh(scene);
  const scene::Camera first = auto_camera(bvh);
  ASSERT_GT(first.origin.z, 2) << "before the open side";
  const Turntable table = turntable(bvh, first, 16);
  EXPECT_EQ(table.turn, Turn::Swing);
  const float distance = length(first.origin - Vec3{1, 1, 1});
  for (const scene::Camera& camera : table.cameras) {
    EXPECT_GT(camera.origin.z, 2);
    EXPECT_NEAR(length(camera.origin - Vec3{1, 1, 1}), distance, 1e-3f);
  }
  const Vec3 side = table.cameras[4].origin - Vec3{1, 1, 1};
  EXPECT_NEAR(std::atan2(side.x, side.z) * 180 / kPi, kSwingDegrees, 0.01f);
  EXPECT_NEAR(table.cameras[12].origin.x - 1, -side.x, 1e-3f);
}

TEST(Turntable, NeedsACamera) {
  const scene::Scene scene = object();
  const Bvh bvh(scene);
  test::error_of([&] { turntable(bvh, {}, 0); });
  EXPECT_EQ(turntable(bvh, {}, 1).cameras.size(), 1u);
}

}  // namespace
}  // namespace lte::pathtrace
