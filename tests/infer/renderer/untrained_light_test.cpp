// Suns and skies before a network that has seen none: what is said, shown to it, and traced in its
// place.
#include "lte/embed/untrained_light.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/embed/scene_points.h"
#include "tests/infer/fixture.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

TEST(UntrainedLight, IsNamedUntilAModelHasSeenSuns) {
  scene::Scene scene = test::dark_room();
  scene.name = "attic";
  nn::ModelMetadata model;
  EXPECT_EQ(embed::untrained_light_note(scene, model), "");
  test::add_punctual(&scene, scene::LightKind::Spot, {1, 1, 1});
  test::add_punctual(&scene, scene::LightKind::Directional, {0, 0, 0});
  EXPECT_EQ(embed::untrained_light_note(scene, model), "") << "a black sun is none";
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  EXPECT_THAT(embed::untrained_light_note(scene, model),
              testing::AllOf(testing::HasSubstr("attic: 1 directional light,"),
                             testing::HasSubstr("its indirect light is wrong here")));
  model.suns = true;
  EXPECT_EQ(embed::untrained_light_note(scene, model), "");
}

TEST(UntrainedLight, AnEnvironmentIsNamedUntilAModelHasSeenSkies) {
  scene::Scene scene = test::dark_room();
  scene.name = "attic";
  nn::ModelMetadata model;
  scene::Environment black;
  scene.environment = black;
  EXPECT_FALSE(embed::has_untrained_light(scene, model)) << "a black one is none";
  EXPECT_EQ(embed::untrained_light_note(scene, model), "");
  scene.environment->radiance = {0, 1, 0};
  EXPECT_TRUE(embed::has_untrained_light(scene, model));
  EXPECT_THAT(embed::untrained_light_note(scene, model),
              testing::AllOf(testing::HasSubstr("attic: an environment,"),
                             testing::HasSubstr("its indirect light is wrong here")));
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  EXPECT_THAT(embed::traced_light_note(scene),
              testing::AllOf(testing::HasSubstr("1 directional light and an environment,"),
                             testing::HasSubstr("path-traced at the places")));
  model.suns = true;
  EXPECT_FALSE(embed::has_untrained_light(scene, model));
}

TEST(UntrainedLight, IsNoneThatTheNetworkIsNotToldOf) {
  scene::Scene scene = test::dark_room();
  scene.name = "attic";
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  const nn::ModelMetadata model;
  const std::vector<int> one = {scene.lights[0].light_group};
  const std::vector<int> both = {one[0], scene.lights[1].light_group};
  EXPECT_TRUE(embed::has_untrained_light(scene, model, one));
  EXPECT_THAT(embed::untrained_light_note(scene, model, one),
              testing::HasSubstr("attic: 1 directional light,"));
  EXPECT_FALSE(embed::has_untrained_light(scene, model, both));
  EXPECT_EQ(embed::untrained_light_note(scene, model, both), "");
}

TEST(UntrainedLight, SunsLeaveThePointsOfAModelThatKnowsNoneWhereOtherLightShines) {
  scene::Scene scene = test::dark_room();
  test::add_punctual(&scene, scene::LightKind::Directional, {1, 1, 1});
  const int sun = scene.lights.back().light_group;
  nn::ModelMetadata model;
  const auto points_of_the_sun = [&] {
    const pathtrace::Bvh bvh(scene);
    scene::SurfaceSamples samples =
        embed::sample_scene_points(bvh, 500, /*prune=*/false, 0, nullptr);
    const int64_t before = samples.size();
    embed::drop_untrained_suns(scene, model, &samples);
    const auto left = std::count(samples.light_group.begin(), samples.light_group.end(), sun);
    EXPECT_EQ(samples.size(), before - 1 + left);
    EXPECT_EQ(samples.area.size(), samples.position.size());
    EXPECT_EQ(samples.emission.size(), samples.position.size());
    return left;
  };
  EXPECT_EQ(points_of_the_sun(), 1) << "no other light: better told than not";
  test::add_punctual(&scene, scene::LightKind::Point, {1, 1, 1});
  EXPECT_EQ(points_of_the_sun(), 0);
  model.suns = true;
  EXPECT_EQ(points_of_the_sun(), 1);
}

}  // namespace
}  // namespace lte::infer
