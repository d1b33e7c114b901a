// Lamps none of whose light meets a surface, or only one right before it.
#include "lte/pathtrace/reach/lost_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/every_light.h"

namespace lte::pathtrace {
namespace {

using test::add_lamp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A floor at y = 0.
scene::Scene floor_alone() {
  scene::Scene scene;
  scene.name = "floor";
  test::add_quad(&scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, test::add_material(&scene, {1, 1, 1}));
  return scene;
}

/// Above the floor; x < 0 turns it upwards.
void add_panel(scene::Scene* scene, float x, bool double_sided = false, float y = 2) {
  add_lamp(scene, {x < 0 ? 0.5f : -0.5f, y, -0.5f}, x, 1, {5, 5, 5}, double_sided);
}

TEST(LostLight, IsThatOfLampsWhoseFrontSeesNothing) {
  scene::Scene scene = floor_alone();
  add_panel(&scene, 1);
  add_panel(&scene, -1);
  add_panel(&scene, -1, /*double_sided=*/true);
  const LostLight lost = find_lost_light(Bvh(scene));
  EXPECT_THAT(lost.missing, ElementsAre(1));
  EXPECT_THAT(lost.enclosed, IsEmpty());
}

TEST(LostLight, IsThatOfLampsWhoseFrontIsAtAWall) {
  scene::Scene scene = floor_alone();
  add_panel(&scene, 1, false, 0.01f);  // down, a finger above the floor
  add_panel(&scene, 1, false, 0.3f);
  const LostLight lost = find_lost_light(Bvh(scene));
  EXPECT_THAT(lost.missing, IsEmpty());
  EXPECT_THAT(lost.enclosed, ElementsAre(0));
}

TEST(LostLight, IsThatOfSpotsThatPointAway) {
  scene::Scene scene = floor_alone();
  for (const float y : {-1.0f, 1.0f}) {
    scene::PunctualLight& spot =
        test::add_punctual(&scene, scene::LightKind::Spot, {1, 1, 1}, {0, 1, 0});
    spot.direction = {0, y, 0};
  }
  test::add_punctual(&scene, scene::LightKind::Point, {1, 1, 1}, {0, 1, 0});
  scene::PunctualLight& near =
      test::add_punctual(&scene, scene::LightKind::Point, {1, 1, 1}, {0, 1, 0});
  near.range = 0.5f;
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  EXPECT_THAT(find_lost_light(Bvh(scene)).missing, ElementsAre(1, 3));
}

TEST(LostLight, IsNoneOfUsualLights) {
  for (const test::LitScene& lit : test::scenes_of_every_light())
    EXPECT_TRUE(find_lost_light(Bvh(lit.scene)).empty()) << lit.light;
}

TEST(LostLight, IsWarnedOfByName) {
  scene::Scene scene = floor_alone();
  for (int i = 0; i < 6; ++i) add_panel(&scene, -1);
  scene.light_groups[0] = "ceiling panel";
  const Bvh bvh(scene);
  testing::internal::CaptureStderr();
  warn_of_lost_light("floor.glb", bvh);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("warning: floor.glb: lamps \"ceiling panel\""));
  EXPECT_THAT(said, HasSubstr(" and 2 more send no light to any surface"));
  EXPECT_THAT(said, HasSubstr("doubleSided"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
}

}  // namespace
}  // namespace lte::pathtrace
