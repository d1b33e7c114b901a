#include "lte/scene/surface.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/scene/scene.h"
#include "lte/scene/texel_densities.h"
#include "tests/scene/expect.h"
#include "tests/support/scenes.h"

namespace lte::scene {
namespace {

using test::expect_near;

/// A unit square in the xy plane, front +z, with UV (x, y), and a 2x2 texture as base color or
/// emission.
Scene textured_square(bool emission) {
  Scene scene;
  Material material;
  const std::vector<uint8_t> texels{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  scene.textures.push_back(std::make_shared<const Texture>(2, 2, texels, true));
  material.base_color = {0.5f, 0.5f, 0.5f};
  material.emission = emission ? Rgb{4, 4, 4} : Rgb{};
  (emission ? material.emission_texture : material.base_color_texture).texture = 0;
  scene.materials.push_back(material);
  test::add_instance(&scene, test::quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0));
  return scene;
}

TEST(Surface, InterpolatesPositionAndUv) {
  const Scene scene = textured_square(false);
  // Triangle 0 is (0,0), (1,0), (1,1): u = 0.5, v = 0.25 is (0.75, 0.25), the centre of the green
  // texel.
  const Surface surface = evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 0);
  expect_near(surface.position, {0.75f, 0.25f, 0});
  expect_near(surface.normal, {0, 0, 1});
  expect_near(surface.albedo, {0, 0.5f, 0});
  expect_near(surface.emission, {0, 0, 0});
  EXPECT_EQ(surface.light_group, kNone);
}

TEST(Surface, EmissionIsFactorTimesTexture) {
  Scene scene = textured_square(true);
  Surface surface = evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 0);
  expect_near(surface.emission, {0, 4, 0});
  EXPECT_EQ(surface.light_group, 0);
  EXPECT_FALSE(surface.emits_back);
  scene.materials[0].double_sided = true;
  EXPECT_TRUE(evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 0).emits_back);
}

TEST(Surface, AveragesOverTheFootprint) {
  // Texture area 4 texels on 1 m²: a footprint of 1 m is 2 texels, the level of one texel, the
  // mean.
  const Scene scene = textured_square(false);
  expect_near(evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 1.0f).albedo, {0.25f, 0.25f, 0.25f},
              1e-5f);
}

TEST(Surface, FootprintFollowsTheInstanceScale) {
  Scene scene = textured_square(false);
  scene.instances[0].to_world = test::scaling({4, 4, 4});
  // 4 m for 2 texels: 1 m is half a texel, so the finest level stays.
  expect_near(evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 1.0f).albedo, {0, 0.5f, 0}, 1e-5f);
}

TEST(Surface, KnownTexelDensitiesChangeNoBit) {
  Scene scene = textured_square(false);
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world = test::scaling({2, 3, 1});
  scene.materials[0].emission = {1, 1, 1};  // two textures of one material
  scene.materials[0].emission_texture = scene.materials[0].base_color_texture;
  scene.materials[0].emission_texture.scale = {3, 3};
  TexelDensities known;
  for (const float footprint : {0.3f, 0.7f, 0.4f, 0.0f}) {
    for (int instance = 0; instance < 2; ++instance) {
      for (uint32_t triangle = 0; triangle < 2; ++triangle) {
        Rgb albedo, emission, same_albedo, same_emission;
        evaluate_appearance(scene, instance, triangle, 0.3f, 0.2f, footprint, &albedo, &emission);
        evaluate_appearance(scene, instance, triangle, 0.3f, 0.2f, footprint, &known, &same_albedo,
                            &same_emission);
        EXPECT_EQ(same_albedo, albedo) << footprint << " " << instance << " " << triangle;
        EXPECT_EQ(same_emission, emission) << footprint << " " << instance << " " << triangle;
      }
    }
  }
}

TEST(Surface, ClampsAlbedoButNotEmission) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].base_color = {3, 0.5f, 1};
  scene.materials[0].emission = {100, 0, 1e-6f};
  Mesh mesh = test::quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  mesh.colors = {{1, 0, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  test::add_instance(&scene, mesh);
  const Surface surface = evaluate_surface(scene, 0, 0, 0.25f, 0.25f, 0);
  expect_near(surface.albedo, {1, 0.25f, 1});
  expect_near(surface.emission, {100, 0, 1e-6f});
}

TEST(Surface, MirroringKeepsTheFrontInFront) {
  // A box whose faces look outwards looks outwards after any transform, of either sign.
  for (const Vec3& scale :
       {Vec3{1, 2, 3}, Vec3{-1, 2, 3}, Vec3{1, -2, 3}, Vec3{-1, -1, -1}, Vec3{-2, -1, 3}}) {
    Scene scene;
    test::add_material(&scene, {1, 1, 1});
    const Affine place = test::translation({5, -3, 2}) *
                         test::rotation(normalize(Vec3{1, 2, 3}), 0.8f) * test::scaling(scale);
    test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, 0, false), place);
    for (uint32_t triangle = 0; triangle < 12; ++triangle) {
      const Surface surface = evaluate_surface(scene, 0, triangle, 0.3f, 0.3f, 0);
      EXPECT_GT(dot(surface.normal, surface.position - Vec3{5, -3, 2}), 0)
          << "triangle " << triangle;
      EXPECT_NEAR(length(surface.normal), 1, 1e-6);
    }
  }
}

TEST(Surface, DegenerateTriangleHasNoNormalAndNoNan) {
  Scene scene = textured_square(false);
  scene.meshes[0].positions = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  const Surface surface = evaluate_surface(scene, 0, 0, 0.2f, 0.2f, 0.1f);
  EXPECT_EQ(surface.normal, (Vec3{0, 0, 0}));
  EXPECT_TRUE(is_finite(surface.position) && is_finite(surface.albedo));
}

TEST(Surface, TinyAndHugeTrianglesHaveUnitNormals) {
  for (const float size : {1e-20f, 1e18f}) {
    Scene scene;
    test::add_material(&scene, {1, 1, 1});
    test::add_quad(&scene, {0, 0, 0}, {size, 0, 0}, {0, size, 0}, 0);
    expect_near(evaluate_surface(scene, 0, 0, 0.2f, 0.2f, 0).normal, {0, 0, 1});
  }
}

TEST(Surface, TextureWithoutItsUvSetCountsAsWhite) {
  Scene scene = textured_square(false);
  scene.materials[0].base_color_texture.uv_set = 1;
  expect_near(evaluate_surface(scene, 0, 0, 0.5f, 0.25f, 0.1f).albedo, {0.5f, 0.5f, 0.5f});
}

TEST(TextureRef, TransformsAsTheExtensionsExampleSays) {
  // "only the lower left quadrant of the source image, rotated clockwise 90 degrees": the picture's
  // top left, UV (0, 0), shows the quadrant's bottom left corner; its top right shows the
  // quadrant's top left.
  TextureRef ref;
  ref.offset = {0, 1};
  ref.scale = {0.5f, 0.5f};
  ref.rotation = 1.57079632679f;
  const auto expect_uv = [&](const Vec2& uv, const Vec2& expected) {
    const Vec2 out = ref.transform(uv);
    EXPECT_NEAR(out.x, expected.x, 1e-6);
    EXPECT_NEAR(out.y, expected.y, 1e-6);
  };
  expect_uv({0, 0}, {0, 1});
  expect_uv({1, 0}, {0, 0.5f});
  expect_uv({0, 1}, {0.5f, 1});
}

TEST(Scene, CountsInstancedTrianglesAndBoundsThem) {
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, 0, false));
  scene.instances.push_back({0, test::translation({10, 0, 0}) * test::scaling({-2, 1, 1}), kNone});
  EXPECT_EQ(scene.triangle_count(), 24);
  expect_near(scene.bounds().low, {0, 0, 0});
  expect_near(scene.bounds().high, {10, 1, 1});
}

TEST(Scene, BoundsLeaveOutVerticesOfNoTriangle) {
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  scene.meshes[0].positions.push_back({100, 100, 100});
  expect_near(scene.bounds().high, {1, 1, 0});
}

TEST(Camera, SpansItsFieldOfView) {
  Camera camera;
  camera.origin = {1, 2, 3};
  camera.target = {1, 2, -7};
  camera.vfov = 90;
  const float h = std::sqrt(0.5f);
  expect_near(camera.direction(0.5f, 0.5f, 2), {0, 0, -1});
  expect_near(camera.direction(0.5f, 0, 2), {0, h, -h});
  expect_near(camera.direction(0.5f, 1, 2), {0, -h, -h});
  expect_near(camera.direction(1, 0.5f, 2), normalize(Vec3{2, 0, -1}));
  expect_near(camera.direction(0, 0, 1), normalize(Vec3{-1, 1, -1}));
}

}  // namespace
}  // namespace lte::scene
