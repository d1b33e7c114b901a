// The list of held-out scenes against their files, and a sample that is baked from one.
#include "lte/data/held_out.h"

#include <filesystem>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/bake/bake.h"
#include "lte/base/file.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/load.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

namespace fs = std::filesystem;

fs::path outside() { return fs::path(LTE_SOURCE_DIR) / "assets/scenes/outside"; }

TEST(HeldOutScenes, TheListIsThatOfTheFiles) {
  std::map<std::string, std::string> listed;
  for (const data::HeldOutScene& scene : data::held_out_scenes())
    listed[scene.name] = scene.geometry;
  size_t files = 0;
  for (const fs::directory_entry& file : fs::directory_iterator(outside())) {
    if (file.path().extension() != ".glb") continue;
    ++files;
    const std::string print = fingerprint(scene::load_scene(file.path())).geometry;
    EXPECT_EQ(listed[file.path().stem().string()], print)
        << file.path() << ": run scripts/assets/list_outside_scenes.py";
  }
  EXPECT_GE(files, 14u);
}

TEST(HeldOutScenes, ASampleOfACopyUnderAnotherNameIsRefused) {
  const lte::test::TempDir own;
  fs::copy_file(outside() / "cube_inside_out.glb", own.path() / "my_room.glb");
  const data::SceneSample sample =
      bake_scene(scene::load_scene(own.path() / "my_room.glb"), tiny_bake(), false);
  EXPECT_EQ(sample.name, "my_room");
  make_directory(own.path() / "scenes");
  data::write_scene_sample(data::scene_path(own.path(), "room_0"), sample);
  EXPECT_THAT(
      data::test::error_of([&] { data::refuse_held_out(own.path(), {{.name = "room_0"}}); }),
      ::testing::AllOf(::testing::HasSubstr("\"room_0\""),
                       ::testing::HasSubstr("cube_inside_out")));
}

}  // namespace
}  // namespace lte::datagen::test
