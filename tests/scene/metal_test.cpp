// How much of a scene is metal.
#include "lte/scene/metal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/scene/load.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(MetalShare, CountsAreaByHowMetallicItIs) {
  Scene scene;
  const int matt = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  const int half = test::add_metal(&scene, {0.5f, 0.5f, 0.5f}, 0.3f, 0.5f);
  const int plain = test::add_metal(&scene, {0.5f, 0.5f, 0.5f}, 1);
  EXPECT_EQ(metal_text(metal_share(scene), "surface"), "") << "nothing at all";
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, plain);
  EXPECT_TRUE(all_metal(scene));
  scene.instances.clear();
  scene.meshes.clear();
  test::add_quad(&scene, {0, 0, 0}, {5, 0, 0}, {0, 1, 0}, matt);
  EXPECT_EQ(metal_share(scene).metal, 0);
  EXPECT_FALSE(all_metal(scene));
  test::add_quad(&scene, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, half);
  const MetalShare mixed = metal_share(scene);
  EXPECT_NEAR(mixed.metal, 1.0 / 7, 1e-6);
  EXPECT_EQ(mixed.by_default, 0);
  EXPECT_EQ(metal_text(mixed, "visible surface"), "14.3 % of the visible surface is metal");
  test::add_instance(&scene, test::quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, plain),
                     test::scaling({3, 1, 1}));
  const MetalShare share = metal_share(scene);
  EXPECT_NEAR(share.metal, 4.0 / 10, 1e-6);
  EXPECT_NEAR(share.by_default, 3.0 / 10, 1e-6);
  EXPECT_THAT(metal_text(share, "surface"),
              AllOf(HasSubstr("40 %"), HasSubstr("as glTF has it where a file says nothing")));
}

TEST(MetalShare, AGltfWithoutMaterialsIsMetalByDefault) {
  const test::TempDir folder;
  // One triangle: three positions as base64, no material.
  write_file(folder / "plain.gltf", R"({"asset": {"version": "2.0"},
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})");
  const MetalShare share = metal_share(load_scene(folder / "plain.gltf"));
  EXPECT_EQ(share.metal, 1);
  EXPECT_EQ(share.by_default, 1);
}

}  // namespace
}  // namespace lte::scene
