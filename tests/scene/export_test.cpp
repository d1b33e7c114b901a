#include "lte/scene/export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/load.h"
#include "tests/scene/expect.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using test::expect_near;

void expect_equal(const TextureRef& a, const TextureRef& b) {
  EXPECT_EQ(a.texture, b.texture);
  EXPECT_EQ(a.uv_set, b.uv_set);
  EXPECT_EQ(a.wrap_u, b.wrap_u);
  EXPECT_EQ(a.wrap_v, b.wrap_v);
  EXPECT_EQ(a.rotation, b.rotation);
  EXPECT_TRUE(a.offset.x == b.offset.x && a.offset.y == b.offset.y);
  EXPECT_TRUE(a.scale.x == b.scale.x && a.scale.y == b.scale.y);
}

void expect_equal(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.normals, b.normals);
  ASSERT_EQ(a.tangents.size(), b.tangents.size());
  for (size_t i = 0; i < a.tangents.size(); ++i) {
    EXPECT_EQ(a.tangents[i].direction, b.tangents[i].direction);
    EXPECT_EQ(a.tangents[i].sign, b.tangents[i].sign);
  }
  EXPECT_EQ(a.material, b.material);
  for (size_t set = 0; set < 2; ++set) {
    ASSERT_EQ(a.uvs[set].size(), b.uvs[set].size());
    for (size_t i = 0; i < a.uvs[set].size(); ++i) {
      EXPECT_TRUE(a.uvs[set][i].x == b.uvs[set][i].x && a.uvs[set][i].y == b.uvs[set][i].y);
    }
  }
}

/// Everything bit for bit, but the frames of cameras and lights, which go through a matrix.
void expect_equal(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (size_t i = 0; i < a.meshes.size(); ++i) expect_equal(a.meshes[i], b.meshes[i]);
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].mesh, b.instances[i].mesh);
    EXPECT_EQ(a.instances[i].to_world.m, b.instances[i].to_world.m);
    EXPECT_EQ(a.instances[i].light_group, b.instances[i].light_group);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].base_color, b.materials[i].base_color);
    EXPECT_EQ(a.materials[i].emission, b.materials[i].emission);
    EXPECT_EQ(a.materials[i].double_sided, b.materials[i].double_sided);
    expect_equal(a.materials[i].base_color_texture, b.materials[i].base_color_texture);
    expect_equal(a.materials[i].emission_texture, b.materials[i].emission_texture);
    expect_equal(a.materials[i].normal_texture, b.materials[i].normal_texture);
    EXPECT_EQ(a.materials[i].normal_scale, b.materials[i].normal_scale);
    EXPECT_EQ(a.materials[i].metallic, b.materials[i].metallic);
    EXPECT_EQ(a.materials[i].roughness, b.materials[i].roughness);
    expect_equal(a.materials[i].metallic_roughness_texture,
                 b.materials[i].metallic_roughness_texture);
  }
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i]->width(), b.textures[i]->width());
    EXPECT_EQ(a.textures[i]->texels(), b.textures[i]->texels());
    EXPECT_EQ(a.textures[i]->srgb(), b.textures[i]->srgb());
  }
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].name, b.lights[i].name);
    EXPECT_EQ(a.lights[i].kind, b.lights[i].kind);
    EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
    EXPECT_EQ(a.lights[i].range, b.lights[i].range);
    EXPECT_EQ(a.lights[i].light_group, b.lights[i].light_group);
    expect_near(a.lights[i].position, b.lights[i].position);
    if (a.lights[i].kind == LightKind::Point) continue;
    expect_near(a.lights[i].direction, b.lights[i].direction);
    if (a.lights[i].kind == LightKind::Directional) continue;
    EXPECT_EQ(a.lights[i].inner_cone, b.lights[i].inner_cone);
    EXPECT_EQ(a.lights[i].outer_cone, b.lights[i].outer_cone);
  }
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (size_t i = 0; i < a.cameras.size(); ++i) {
    EXPECT_EQ(a.cameras[i].name, b.cameras[i].name);
    expect_near(a.cameras[i].origin, b.cameras[i].origin);
    for (const Vec2& p : {Vec2{0, 0}, Vec2{0.5f, 0.5f}, Vec2{1, 0.2f}}) {
      expect_near(a.cameras[i].direction(p.x, p.y, 1.5f), b.cameras[i].direction(p.x, p.y, 1.5f));
    }
  }
  EXPECT_EQ(a.light_groups, b.light_groups);
}

/// A room with everything that a scene can hold.
Scene rich_scene() {
  Scene scene = test::furnished_room();
  scene.name = "rich";
  std::vector<uint8_t> texels;
  for (int i = 0; i < 5 * 3 * 3; ++i) texels.push_back(static_cast<uint8_t>(i * 5));
  scene.textures.push_back(std::make_shared<const Texture>(5, 3, texels, true));
  scene.textures.push_back(
      std::make_shared<const Texture>(1, 1, std::vector<uint8_t>{250, 3, 77}, true));
  scene.textures.push_back(
      std::make_shared<const Texture>(1, 1, std::vector<uint8_t>{0, 130, 255}, false));
  scene.materials[1].metallic = 0.3f;
  scene.materials[1].roughness = 0.7f;
  scene.materials[2].metallic = 1;
  scene.materials[2].roughness = 0;
  scene.materials[2].metallic_roughness_texture.texture = 2;
  scene.materials[1].normal_texture.texture = 2;
  scene.materials[1].normal_scale = 0.7f;
  for (Mesh& mesh : scene.meshes) {
    if (mesh.material != 1) continue;
    mesh.normals.assign(mesh.positions.size(), {0, 0.6f, 0.8f});
    mesh.tangents.assign(mesh.positions.size(), {{1, 0, 0}, -1});
  }
  TextureRef ref;
  ref.texture = 1;
  ref.uv_set = 1;
  ref.wrap_u = Wrap::ClampToEdge;
  ref.wrap_v = Wrap::MirroredRepeat;
  ref.offset = {0.1f, -2};
  ref.scale = {3, 0.7f};
  ref.rotation = 0.3f;
  scene.materials[0].base_color_texture = ref;
  scene.materials[3].emission = {0.3f, 17.123f, 1e-3f};
  scene.materials[3].double_sided = true;
  scene.materials[3].emission_texture.texture = 0;
  Mesh& room = scene.meshes[0];
  room.uvs[1] = room.uvs[0];
  room.colors.assign(room.positions.size(), Rgb{0.2f, 0.4f, 0.9f});
  // The same lamp again, mirrored: one mesh, two luminaires.
  scene.instances.push_back({3, test::translation({0.1f, 0, 0}) * test::scaling({-1, 1, 1}), 2});
  scene.light_groups.push_back("twin");
  test::add_point_light(&scene, {1, 2, 1}, {3.7f, 2, 0});
  PunctualLight light = scene.lights[0];
  light.name = "spot";
  light.kind = LightKind::Spot;
  light.direction = normalize(Vec3{1, -2, 0.5f});
  light.range = 12.5f;
  light.inner_cone = 0.2f;
  light.outer_cone = 0.6f;
  light.light_group = 4;
  scene.lights.push_back(light);
  light = {};
  light.name = "sun";
  light.kind = LightKind::Directional;
  light.direction = {0, -1, 0};
  light.intensity = {1, 0.9f, 0.8f};
  light.light_group = 5;
  scene.lights.push_back(light);
  scene.light_groups.insert(scene.light_groups.end(), {"spot", "sun"});
  Camera camera;
  camera.name = "door";
  camera.origin = {0.2f, 1.6f, 0.2f};
  camera.target = {3, 1, 2};
  camera.vfov = 63;
  scene.cameras.push_back(camera);
  camera.name = "mirror";
  camera.mirrored = true;
  scene.cameras.push_back(camera);
  return scene;
}

TEST(Export, LoadingWhatWasWrittenGivesTheSameScene) {
  const test::TempDir dir;
  const Scene scene = rich_scene();
  write_glb(dir / "rich.glb", scene);
  const Scene loaded = load_scene(dir / "rich.glb");
  EXPECT_EQ(loaded.name, "rich");
  expect_equal(scene, loaded);
  EXPECT_THAT(loaded.ignored, ::testing::IsEmpty());
}

TEST(Export, SecondRoundTripChangesNothing) {
  const test::TempDir dir;
  write_glb(dir / "first.glb", rich_scene());
  const Scene first = load_scene(dir / "first.glb");
  write_glb(dir / "second.glb", first);
  expect_equal(first, load_scene(dir / "second.glb"));
}

TEST(Export, SharesMeshesBetweenInstances) {
  const test::TempDir dir;
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, 0, false));
  write_glb(dir / "one.glb", scene);
  for (int i = 1; i < 50; ++i)
    scene.instances.push_back({0, test::translation({static_cast<float>(i), 0, 0}), kNone});
  write_glb(dir / "fifty.glb", scene);
  EXPECT_EQ(load_scene(dir / "fifty.glb").meshes.size(), 1u);
  EXPECT_EQ(load_scene(dir / "fifty.glb").instances.size(), 50u);
  EXPECT_LT(std::filesystem::file_size(dir / "fifty.glb"),
            std::filesystem::file_size(dir / "one.glb") + 50 * 200);
}

TEST(Export, ReachesAWholeFileOrNone) {
  const test::TempDir dir;
  EXPECT_THAT(test::error_of([&] { write_glb(dir / "no such folder/a.glb", rich_scene()); }),
              ::testing::HasSubstr("a.glb"));
  EXPECT_EQ(dir.count(), 0u);
}

TEST(Export, RefusesNamesThatAreNotText) {
  const test::TempDir dir;
  Scene scene = rich_scene();
  scene.meshes[0].name = "\xff\xfe";
  EXPECT_THAT(test::error_of([&] { write_glb(dir / "a.glb", scene); }),
              ::testing::HasSubstr("a.glb"));
}

}  // namespace
}  // namespace lte::scene
