// Data sets of scene files.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/dataset/generate.h"
#include "lte/base/file.h"
#include "lte/data/dataset.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "lte/scene/load_camera.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/dataset/generate_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Scenes written as files, one of them with a camera beside it.
TEST_F(Generate, ScenesOfFilesAreReadAndRefusedWhereThereAreTooFew) {
  DatagenConfig made = tiny_config();
  const std::filesystem::path folder = folder_ / "mine";
  std::filesystem::create_directories(folder / "inner");
  const auto write = [&](const char* name, int64_t index) {
    scene::write_glb(folder / name, make_scene(made, index));
  };
  write("b.glb", 0);
  write("inner/c.glb", 1);
  const scene::Scene scene = scene::load_scene(folder / "b.glb");
  const scene::Camera camera = pathtrace::auto_camera(pathtrace::Bvh(scene), 7);
  write_file(folder / "b.camera.json", scene::camera_json(camera));

  DatagenConfig config = tiny_config();
  config.generator = GeneratorKind::Files;
  config.files.folder = folder.string() + "s";
  EXPECT_THAT(error_of([&] { generate("read", config); }),
              AllOf(HasSubstr("files.folder"), HasSubstr(config.files.folder)));
  config.files.folder = folder.string();
  config.scenes = 3;
  EXPECT_THAT(error_of([&] { generate("read", config); }),
              AllOf(HasSubstr("scenes: expected at most 2"), HasSubstr("mine"), HasSubstr("3")));
  config.scenes = 2;
  EXPECT_EQ(generate("read", config).baked, 2);
  EXPECT_EQ(read_manifests(folder_ / "read").at(1).source, "inner/c.glb");
  const data::SceneSample first =
      data::read_scene_sample(data::scene_path(folder_ / "read", "scene_00000"));
  BakeOptions options = bake_options(config, 0, make_scene(config, 0));
  ASSERT_EQ(options.view_cameras.size(), 1u);
  EXPECT_EQ(options.view_cameras[0].origin.x, camera.origin.x);
  const data::SceneSample same = bake_scene(scene, options, false);
  EXPECT_EQ(floats(first.indirect), floats(same.indirect));
  ASSERT_EQ(first.views.size(), 1u);
  EXPECT_EQ(floats(first.views[0].indirect), floats(same.views[0].indirect));

  // A file more, before the others: each scene is another one now.
  write("a.glb", 2);
  EXPECT_EQ(generate("read", config, true).baked, 2);
  EXPECT_EQ(read_manifests(folder_ / "read").at(1).source, "b.glb");
  EXPECT_EQ(generate("read", config, true).kept, 2);
  write_file(folder / "0.glb", "no scene");
  EXPECT_EQ(generate("read", config, true).failed, 1);
  const data::DatasetInfo left = data::read_dataset_info(folder_ / "read");
  ASSERT_EQ(left.scenes.size(), 1u) << "what was read in the place of a broken file is gone";
  EXPECT_EQ(left.scenes[0].name, "scene_00001");
}

}  // namespace
}  // namespace lte::datagen::test
