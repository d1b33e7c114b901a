// Normal maps against directions in closed form.
#include "lte/scene/shading_normal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/scene/expect.h"
#include "tests/support/scenes.h"

namespace lte::scene {
namespace {

using test::expect_near;

/// The direction that a texel stands for: x along U, y up the picture.
Vec3 direction_of(int r, int g, int b, float scale = 1) {
  const auto part = [](int code) { return 2 * static_cast<float>(code - 128) / 255; };
  return normalize({part(r) * scale, part(g) * scale, 2 * static_cast<float>(b) / 255 - 1});
}

/// A unit square, front +z, whose UV (x, y) run along its edges, so that up the picture is −y.
struct Square {
  explicit Square(std::vector<uint8_t> texel = {200, 70, 230}) {
    test::add_material(&scene, {0.5f, 0.5f, 0.5f});
    scene.materials[0].normal_texture.texture = 0;
    scene.textures.push_back(std::make_shared<const Texture>(1, 1, std::move(texel), false));
    test::add_instance(&scene, test::quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0));
  }
  Mesh& mesh() { return scene.meshes[0]; }
  Vec3 normal(const Vec3& front = {0, 0, 1}, uint32_t triangle = 0) const {
    return shading_normal(scene, 0, triangle, 0.3f, 0.2f, 0, front);
  }

  Scene scene;
};

TEST(ShadingNormal, AFlatMapKeepsEveryBit) {
  Square square({128, 128, 255});
  const Vec3 front = normalize({0.3f, -0.2f, 0.9f});
  EXPECT_EQ(square.normal(front), front);
  square.mesh().normals.assign(4, {0, 0, 1});
  EXPECT_EQ(square.normal(), (Vec3{0, 0, 1}));
}

TEST(ShadingNormal, FollowsThePicturesAxesOnBothTriangles) {
  const Vec3 n = direction_of(200, 70, 230);
  for (const uint32_t triangle : {0u, 1u})
    expect_near(Square().normal({0, 0, 1}, triangle), {n.x, -n.y, n.z});
}

TEST(ShadingNormal, MirroredAndTurnedTextureCoordinatesTurnTheMap) {
  const Vec3 n = direction_of(200, 70, 230);
  Square mirrored;
  for (Vec2& uv : mirrored.mesh().uvs[0]) uv.x = 1 - uv.x;
  expect_near(mirrored.normal(), {-n.x, -n.y, n.z});
  Square turned;  // U along +y, V along −x
  turned.mesh().uvs[0] = {{0, 0}, {0, -1}, {1, -1}, {1, 0}};
  expect_near(turned.normal(), {n.y, n.x, n.z});
  Square transformed;
  transformed.scene.materials[0].normal_texture.scale = {-2, 3};
  expect_near(transformed.normal(), {-n.x, -n.y, n.z});
}

TEST(ShadingNormal, TheScaleIsOfXAndY) {
  Square square;
  square.scene.materials[0].normal_scale = 0.25f;
  const Vec3 n = direction_of(200, 70, 230, 0.25f);
  expect_near(square.normal(), {n.x, -n.y, n.z});
}

TEST(ShadingNormal, GivenTangentsAndNormalsComeFirst) {
  const Vec3 n = direction_of(200, 70, 230);
  Square square;
  square.mesh().normals.assign(4, {0, 0, 1});
  square.mesh().tangents.assign(4, {{0, 3, 1}, -1});  // not unit, not at a right angle
  expect_near(square.normal(), {n.y, n.x, n.z});      // x is +y; y is −(z × y) = +x
  Square tilted({128, 128, 255});
  const Vec3 lean = normalize({0.2f, 0.1f, 1});
  tilted.mesh().normals.assign(4, lean * 7);
  expect_near(tilted.normal(), lean);
  tilted.mesh().normals.assign(4, {0, 0, -1});
  EXPECT_EQ(tilted.normal(), (Vec3{0, 0, 1})) << "behind the surface";
}

TEST(ShadingNormal, IsThatOfTheWorld) {
  // Stretched along x: the map stays at right angles to the surface and along its picture.
  const Vec3 n = direction_of(200, 70, 230);
  Square stretched;
  stretched.scene.instances[0].to_world = test::scaling({5, 1, 1});
  expect_near(stretched.normal(), {n.x, -n.y, n.z});
  // A mirror image has the mirrored normal, from UV and from tangents.
  for (const bool given : {false, true}) {
    Square mirrored;
    if (given) {
      mirrored.mesh().normals.assign(4, {0, 0, 1});
      mirrored.mesh().tangents.assign(4, {{1, 0, 0}, -1});
    }
    expect_near(mirrored.normal(), {n.x, -n.y, n.z});
    mirrored.scene.instances[0].to_world = test::scaling({-1, 1, 1});
    expect_near(mirrored.normal(), {-n.x, -n.y, n.z});
  }
  // Normals that lean go by the inverse transpose.
  Square leaning({128, 128, 255});
  leaning.mesh().normals.assign(4, {0.5f, 0, 1});
  leaning.scene.instances[0].to_world = test::scaling({2, 1, 1});
  expect_near(leaning.normal(), normalize({0.25f, 0, 1}));
}

TEST(ShadingNormal, WithoutDirectionsTheNormalStays) {
  Square square;
  for (Vec2& uv : square.mesh().uvs[0]) uv = {0.5f, 0.5f};
  EXPECT_EQ(square.normal(), (Vec3{0, 0, 1}));
  EXPECT_TRUE(has_normal_map(square.scene, square.scene.instances[0]));
  square.mesh().uvs[0].clear();
  EXPECT_FALSE(has_normal_map(square.scene, square.scene.instances[0])) << "nothing to look up by";
  square.scene.materials[0].normal_texture.texture = kNone;
  EXPECT_FALSE(has_normal_map(square.scene, square.scene.instances[0]));
}

}  // namespace
}  // namespace lte::scene
