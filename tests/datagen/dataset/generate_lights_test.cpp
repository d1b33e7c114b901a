// What data sets say of the lights of their scenes, and what their .glb files have.
#include <algorithm>

#include <gtest/gtest.h>

#include "lte/data/dataset.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/load.h"
#include "tests/datagen/dataset/generate_fixture.h"

namespace lte::datagen::test {
namespace {

TEST_F(Generate, SetsWithSunsSayIt) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  config.generator = GeneratorKind::Homes;
  config.homes.rooms = {1, 1};
  config.homes.detail = {0.3, 0.3};
  config.homes.texture_sizes = {8};
  config.homes.daylight_share = 1;
  generate("panes", config);
  EXPECT_FALSE(data::read_dataset_info(folder_ / "panes").suns);
  config.homes.sun_share = 1;
  config.bake.prune = true;
  generate("suns", config);
  EXPECT_TRUE(data::read_dataset_info(folder_ / "suns").suns);
  const data::SceneSample home = data::read_scene_sample(
      data::scene_path(folder_ / "suns", scene_name(GeneratorKind::Homes, 0)));
  const auto sun = static_cast<int>(home.light_groups) - 2;
  EXPECT_EQ(std::count(home.scene_light.begin(), home.scene_light.end(), sun), 1);
  EXPECT_GE(std::count(home.scene_light.begin(), home.scene_light.end(), sun + 1), 1) << "the sky";
}

TEST_F(Generate, SetsOfBoxesWithSkiesSayItAndShowIt) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  config.boxes.sky_share = 1;
  config.boxes.width_m = config.boxes.depth_m = {3, 4};
  generate("closed", config);
  EXPECT_FALSE(data::read_dataset_info(folder_ / "closed").suns) << "no side is open";
  config.boxes.shut_sky_share = 1;
  generate("shut", config);
  EXPECT_TRUE(data::read_dataset_info(folder_ / "shut").suns);
  config.boxes.open_share = 1;
  generate("sky", config);
  EXPECT_TRUE(data::read_dataset_info(folder_ / "sky").suns);
  const data::SceneSample box = data::read_scene_sample(
      data::scene_path(folder_ / "sky", scene_name(GeneratorKind::Boxes, 0)));
  const auto sky = static_cast<int>(box.light_groups) - 1;
  EXPECT_GE(std::count(box.scene_light.begin(), box.scene_light.end(), sky), 1);
}

TEST_F(Generate, GlbIsTheSceneThatWasBaked) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  GenerateOptions options;
  options.out = folder_ / "a";
  options.glb = true;
  generate_dataset(config, options);
  const scene::Scene loaded = scene::load_scene(folder_ / "a" / "scenes" / "box_00000.glb");
  const boxes::Room room = boxes::generate_room(config.boxes, scene_seed(config.seed, 0));
  EXPECT_EQ(loaded.triangle_count(), room.scene.triangle_count());
  EXPECT_EQ(loaded.light_groups.size(), room.scene.light_groups.size());
  const Vec3 difference = loaded.bounds().high - room.scene.bounds().high;
  EXPECT_LT(length(difference), 1e-4f);
  EXPECT_EQ(loaded.cameras.size(), 1u);
}

TEST_F(Generate, TheSkyOfAGlbStandsBesideIt) {
  for (const double pictures : {0.0, 1.0}) {
    DatagenConfig config = tiny_config();
    config.scenes = 1;
    config.boxes.width_m = config.boxes.depth_m = {3, 4};
    config.boxes.open_share = config.boxes.sky_share = 1;
    config.boxes.sky_picture_share = pictures;
    GenerateOptions options;
    options.out = folder_ / (pictures > 0 ? "pictures" : "plain");
    options.glb = true;
    generate_dataset(config, options);
    const std::filesystem::path scenes = options.out / "scenes";
    scene::Scene loaded = scene::load_scene(scenes / "box_00000.glb");
    EXPECT_FALSE(loaded.environment);
    scene::set_environment(scenes / "box_00000.sky.exr", 0, &loaded);
    const boxes::Room room = boxes::generate_room(config.boxes, scene_seed(config.seed, 0));
    ASSERT_TRUE(room.scene.environment);
    EXPECT_EQ(room.scene.environment->map != nullptr, pictures > 0);
    EXPECT_EQ(loaded.light_groups.size(), room.scene.light_groups.size());
    for (const Vec3& d : {Vec3{0, 1, 0}, Vec3{0.6f, 0.8f, 0}, Vec3{-0.8f, 0, 0.6f},
                          Vec3{0, -0.6f, 0.8f}, Vec3{0, 0.6f, -0.8f}})
      EXPECT_EQ(loaded.environment->radiance_from(d), room.scene.environment->radiance_from(d));
  }
}

}  // namespace
}  // namespace lte::datagen::test
