// Luminaires that bring no light to what is seen: which they are, and that no network reads them.
#include "lte/embed/culled_lights.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/embed/scene_points.h"
#include "tests/infer/fixture.h"
#include "tests/infer/renderer/two_rooms.h"

namespace lte::infer {
namespace {

using test::TwoRooms;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<int> culled_by(const TwoRooms& rooms, const std::vector<scene::Camera>& cameras) {
  const pathtrace::Bvh bvh(rooms.scene);
  return embed::culled_lights(bvh, embed::Receivers(cameras), 0);
}

TEST(CulledLights, IsThatOfOtherRoomsAndOfTheSkyOutside) {
  // However bright it is, and however dim the lamp is beside it.
  for (const float sky : {1.0f, 1e4f}) {
    const TwoRooms rooms(sky);
    EXPECT_THAT(culled_by(rooms, {TwoRooms::inside()}), ElementsAre(rooms.other_lamp, rooms.sky));
    EXPECT_THAT(culled_by(rooms, {TwoRooms::outside()}), ElementsAre(rooms.lamp, rooms.other_lamp));
    EXPECT_THAT(culled_by(rooms, {TwoRooms::inside(), TwoRooms::outside()}),
                ElementsAre(rooms.other_lamp));
  }
}

TEST(CulledLights, IsNoneThatComesInThroughAnOpening) {
  const TwoRooms rooms(1, /*roof=*/false);
  EXPECT_THAT(culled_by(rooms, {TwoRooms::inside()}), ElementsAre(rooms.other_lamp));
}

TEST(CulledLights, IsUnknownWhereNoSurfaceIsSeen) {
  const TwoRooms rooms;
  const scene::Camera up = {"up", {2, 8, 2}, {2, 9, 2}, {1, 0, 0}, 40};
  EXPECT_THAT(culled_by(rooms, {up}), IsEmpty());
  EXPECT_THAT(culled_by(rooms, {}), IsEmpty());
}

TEST(CulledLights, OfPointsIsThatOfEachOfThem) {
  const TwoRooms rooms(1e4f);
  const pathtrace::Bvh bvh(rooms.scene);
  const Vec3 up{0, 1, 0};
  // However many points there are beside the one that it reaches.
  for (const size_t in_the_first : {1, 20000}) {
    std::vector<Vec3> position(in_the_first, Vec3{1, 0, 1}), normal(in_the_first, up);
    EXPECT_THAT(embed::culled_lights(bvh, embed::SurfacePlaces{position, normal}, 0),
                ElementsAre(rooms.other_lamp, rooms.sky));
    position.push_back({11, 0, 1});
    normal.push_back(up);
    EXPECT_THAT(embed::culled_lights(bvh, embed::SurfacePlaces{position, normal}, 0),
                ElementsAre(rooms.sky));
  }
  EXPECT_THAT(embed::culled_lights(bvh, embed::SurfacePlaces{}, 0), IsEmpty());
}

TEST(CulledLights, HasNames) {
  const TwoRooms rooms;
  const std::array groups = {rooms.other_lamp, rooms.sky};
  EXPECT_THAT(embed::names_of(rooms.scene, groups), ElementsAre("light1", "the sky"));
  EXPECT_EQ(embed::culled_lights_note(rooms.scene, groups, embed::SurfacePlaces{}),
            "the network does not read light that does not reach the points (light1, the sky); "
            "with --set prune=off it reads all");
  EXPECT_THAT(embed::culled_lights_note(rooms.scene, groups, std::vector{TwoRooms::inside()}),
              testing::HasSubstr("does not reach what is seen (light1, the sky)"));
}

/// What a network answers at the floor of the first room.
Rgb answer(float sky, const std::vector<int>& culled, nn::LightInput light_input, bool prune) {
  const TwoRooms rooms(sky);
  const test::TempDir folder;
  test::save_tiny_model(
      folder / "tiny.safetensors",
      {.scene_points = 400, .pruned = true, .suns = true, .light_input = light_input});
  const runtime::Network network(folder / "tiny.safetensors");
  Renderer renderer(rooms.scene);
  EmbedSettings settings;
  settings.culled_lights = culled;
  settings.prune = prune;
  renderer.embed(network, settings);
  const std::vector<Vec3> position = {{1, 0, 1}}, normal = {{0, 1, 0}};
  const std::vector<Rgb> albedo = {{0.5f, 0.5f, 0.5f}};
  return renderer.embedding().decode({position, normal, albedo})[0];
}

TEST(CulledLights, IsNothingThatTheNetworkIsToldOf) {
  const TwoRooms rooms;
  const std::vector<int> sky = {rooms.sky};
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    const auto red = [&](float radiance, const std::vector<int>& culled, bool prune) {
      return answer(radiance, culled, input, prune).x;
    };
    EXPECT_EQ(red(1, sky, true), red(1000, sky, true)) << enum_name(input);
    EXPECT_NE(red(1, {}, true), red(1000, {}, true)) << enum_name(input);
    EXPECT_NE(red(1, sky, false), red(1000, sky, false)) << "without pruning it is told of all";
  }
}

TEST(CulledLights, MayBeAll) {
  const TwoRooms rooms;
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    const Rgb dark = answer(1, {rooms.lamp, rooms.other_lamp, rooms.sky}, input, true);
    EXPECT_EQ(dark, Rgb()) << enum_name(input);
  }
}

TEST(CulledLights, MayBeAllThereIs) {
  // A lamp that faces away from the only other surface: no point is lit but its own.
  scene::Scene scene;
  scene.name = "away";
  test::add_quad(&scene, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0},
                 test::add_material(&scene, {0.5f, 0.5f, 0.5f}));
  test::add_quad(&scene, {-1, 1, -1}, {0, 0, 1}, {1, 0, 0},
                 test::add_material(&scene, {0, 0, 0}, {5, 5, 5}));
  const pathtrace::Bvh bvh(scene);
  const scene::SurfaceSamples samples =
      embed::sample_scene_points(bvh, 300, /*prune=*/true, 0, nullptr, {}, {0});
  EXPECT_GT(samples.size(), 0);
  for (size_t i = 0; i < samples.position.size(); ++i) {
    EXPECT_EQ(samples.emission[i], Rgb());
    EXPECT_EQ(samples.light_group[i], scene::kNone);
  }
}

TEST(CulledLights, LeavesNoPointsThatItAloneReaches) {
  const TwoRooms rooms;
  const pathtrace::Bvh bvh(rooms.scene);
  pathtrace::PruneCounts counts;
  const scene::SurfaceSamples all =
      embed::sample_scene_points(bvh, 600, /*prune=*/true, 0, &counts);
  const scene::SurfaceSamples some = embed::sample_scene_points(
      bvh, 600, /*prune=*/true, 0, &counts, {}, {rooms.other_lamp, rooms.sky});
  const auto in_the_other_room = [](const scene::SurfaceSamples& samples) {
    return std::ranges::count_if(samples.position, [](const Vec3& p) { return p.x > 5; });
  };
  EXPECT_GT(in_the_other_room(all), 100);
  EXPECT_EQ(in_the_other_room(some), 0);
  for (const int group : some.light_group)
    EXPECT_TRUE(group == scene::kNone || group == rooms.lamp);
  EXPECT_GT(some.size(), 450) << "what is left stands closer";
}

TEST(CulledLights, LeavesZerosInEstimates) {
  pathtrace::LightEstimates light;
  light.direct.assign(3 * 2, Rgb{1, 2, 3});
  light.indirect_back = light.direct;
  light.error.assign(3 * 2, 0.5f);
  const std::array groups = {0, 2};
  embed::darken(groups, 3, &light);
  for (size_t i = 0; i < 6; ++i) {
    const bool stays = i / 2 == 1;
    EXPECT_EQ(light.direct[i].x, stays ? 1 : 0);
    EXPECT_EQ(light.indirect_back[i].z, stays ? 3 : 0);
    EXPECT_EQ(light.error[i], stays ? 0.5f : 0.0f);
  }
  EXPECT_TRUE(light.indirect.empty());
}

}  // namespace
}  // namespace lte::infer
