// Places near small lamps: by distance, side and the way that the lamp shines.
#include "lte/gi/near_lamps.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

constexpr float kReach = 0.2f;
const Vec3 kUp{0, 1, 0}, kDown{0, -1, 0};

/// A square lamp around the origin whose front looks down.
scene::Scene lamp_of(float edge, bool two_sided) {
  scene::Scene scene;
  const int lamp = test::add_material(&scene, {}, {1, 1, 1}, two_sided);
  test::add_quad(&scene, {-edge / 2, 0, -edge / 2}, {edge, 0, 0}, {0, 0, edge}, lamp);
  return scene;
}

TEST(NearLamps, ArePlacesWithinReachOnTheSideOfTheLamp) {
  const NearLamps lamps(lamp_of(0.05f, true), kReach);
  EXPECT_TRUE(lamps.above({0, -0.15f, 0}, kUp));
  EXPECT_TRUE(lamps.above({0, 0.15f, 0}, kDown));
  EXPECT_FALSE(lamps.above({0, -0.15f, 0}, kDown)) << "it is behind the surface";
  EXPECT_FALSE(lamps.above({0, -0.25f, 0}, kUp));
  EXPECT_FALSE(lamps.above({0.15f, -0.15f, 0}, kUp));
  EXPECT_FALSE(lamps.above({7, -9, 5}, kUp));
}

TEST(NearLamps, OneSideShinesOneWay) {
  const NearLamps lamps(lamp_of(0.05f, false), kReach);
  EXPECT_TRUE(lamps.above({0, -0.1f, 0}, kUp));
  EXPECT_FALSE(lamps.above({0, 0.1f, 0}, kDown));
}

TEST(NearLamps, LargeOnesDoNotCount) {
  EXPECT_FALSE(NearLamps(lamp_of(0.5f, true), kReach).above({0, -0.1f, 0}, kUp));
  EXPECT_FALSE(NearLamps(lamp_of(0.5f, true), kReach).above({0.1f, -0.1f, 0.1f}, kUp));
}

TEST(NearLamps, BlackAndDistantLightsAreNoLamps) {
  scene::Scene scene;
  const int black = test::add_material(&scene, {1, 1, 1}, {}, true);
  test::add_quad(&scene, {-0.02f, 0, -0.02f}, {0.04f, 0, 0}, {0, 0, 0.04f}, black);
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.intensity = {1, 1, 1};
  scene.lights.push_back(sun);
  EXPECT_FALSE(NearLamps(scene, kReach).above({0, -0.1f, 0}, kUp));
  scene.lights[0].kind = scene::LightKind::Point;
  EXPECT_TRUE(NearLamps(scene, kReach).above({0, -0.1f, 0}, kUp));
}

}  // namespace
}  // namespace lte::gi
