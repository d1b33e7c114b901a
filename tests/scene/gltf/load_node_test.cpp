// Hierarchies, cameras and punctual lights.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/surface.h"
#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::ElementsAre;

const double kHalf = std::sqrt(0.5);

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-6f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
}

class LoadNode : public test::GltfTest {
 protected:
  LoadNode() {
    builder_.mesh(builder_.triangle());
    builder_.json["nodes"] = Json::array();
  }

  Scene load() { return GltfTest::load(builder_); }

  Json& nodes() { return builder_.json["nodes"]; }

  GltfBuilder builder_;
};

TEST_F(LoadNode, AppliesScaleThenRotationThenTranslation) {
  // A quarter turn about z takes x to y.
  nodes() = {{{"mesh", 0},
              {"translation", {10, 20, 30}},
              {"rotation", {0, 0, kHalf, kHalf}},
              {"scale", {2, 3, 4}}}};
  const Affine m = load().instances[0].to_world;
  expect_near(m.point({0, 0, 0}), {10, 20, 30});
  expect_near(m.point({1, 0, 0}), {10, 22, 30}, 1e-5f);
  expect_near(m.point({0, 1, 0}), {7, 20, 30}, 1e-5f);
  expect_near(m.point({0, 0, 1}), {10, 20, 34}, 1e-5f);
}

TEST_F(LoadNode, RotatesAboutEachAxisByTheRightHand) {
  nodes() = {{{"mesh", 0}, {"rotation", {kHalf, 0, 0, kHalf}}},
             {{"mesh", 0}, {"rotation", {0, 2, 0, 2}}}};
  const Scene scene = load();
  expect_near(scene.instances[0].to_world.vector({0, 1, 0}), {0, 0, 1});
  expect_near(scene.instances[1].to_world.vector({0, 0, 1}),
              {1, 0, 0});  // not normalized in the file
}

TEST_F(LoadNode, ReadsMatricesByColumn) {
  nodes() = {{{"mesh", 0}, {"matrix", {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1}}}};
  const Affine m = load().instances[0].to_world;
  expect_near(m.vector({1, 0, 0}), {1, 2, 3});
  expect_near(m.vector({0, 1, 0}), {4, 5, 6});
  expect_near(m.point({0, 0, 1}), {18, 20, 23});
}

TEST_F(LoadNode, ComposesParentsFirst) {
  nodes() = {{{"scale", {2, 2, 2}}, {"children", {2}}},
             {{"mesh", 0}},
             {{"translation", {1, 0, 0}}, {"children", {3}}},
             {{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  const Scene scene = load();
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(scene.instances[0].to_world.point({1, 0, 0}), {0, 0, 0});  // 2 * (1 - 1)
  expect_near(scene.instances[0].to_world.point({0, 1, 0}), {2, 2, 0});
  expect_near(scene.instances[1].to_world.point({1, 0, 0}), {1, 0, 0});
}

TEST_F(LoadNode, NegativeDeterminantKeepsTheFront) {
  nodes() = {
      {{"mesh", 0}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}, {{"mesh", 0}, {"scale", {1, 1, -1}}}};
  const Scene scene = load();
  expect_near(evaluate_surface(scene, 0, 0, 0.3f, 0.3f, 0).normal, {0, 0, 1});
  expect_near(evaluate_surface(scene, 1, 0, 0.3f, 0.3f, 0).normal, {0, 0, 1});
  expect_near(evaluate_surface(scene, 2, 0, 0.3f, 0.3f, 0).normal, {0, 0, -1});
}

TEST_F(LoadNode, FarParentsCostNoDigits) {
  nodes() = {{{"translation", {1e9, 0, 0}}, {"children", {1}}},
             {{"mesh", 0}, {"translation", {-999999999.75, 0, 0}}}};
  EXPECT_EQ(load().instances[0].to_world.m[0][3], 0.25f);
}

TEST_F(LoadNode, TakesTheDefaultSceneElseTheFirstElseAllRoots) {
  nodes() = {{{"mesh", 0}},
             {{"mesh", 0}, {"translation", {1, 0, 0}}},
             {{"mesh", 0}, {"translation", {2, 0, 0}}}};
  const auto shifts = [&] {
    std::vector<float> out;
    for (const Instance& instance : load().instances) out.push_back(instance.to_world.m[0][3]);
    return out;
  };
  EXPECT_THAT(shifts(), ElementsAre(0, 1, 2));
  builder_.json["scenes"] = {{{"nodes", {1}}}, {{"nodes", {2, 0}}}};
  EXPECT_THAT(shifts(), ElementsAre(1));
  builder_.json["scene"] = 1;
  EXPECT_THAT(shifts(), ElementsAre(2, 0));
}

TEST_F(LoadNode, ReadsPerspectiveCameras) {
  nodes() = {{{"mesh", 0}},
             {{"camera", 1},
              {"name", "eye"},
              {"translation", {1, 2, 3}},
              {"rotation", {0, kHalf, 0, kHalf}},
              {"scale", {5, 5, 5}}},
             {{"camera", 0}}};
  builder_.json["cameras"] = {
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}},
      {{"type", "perspective"}, {"perspective", {{"yfov", M_PI / 3}, {"znear", 0.1}}}}};
  const Scene scene = load();
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.name, "eye");
  EXPECT_NEAR(camera.vfov, 60, 1e-4);
  expect_near(camera.origin, {1, 2, 3});
  expect_near(camera.target, {0, 2, 3});  // -z turned about y by a quarter is -x
  expect_near(camera.up, {0, 1, 0});
  EXPECT_THAT(scene.ignored, ElementsAre("orthographic projection (1 camera)"));
}

TEST_F(LoadNode, LeavesOutACameraThatSeesNothing) {
  nodes() = {{{"mesh", 0}}, {{"camera", 0}, {"scale", {0, 0, 0}}}};
  builder_.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  const Scene scene = load();
  EXPECT_TRUE(scene.cameras.empty());
  EXPECT_THAT(scene.ignored, ElementsAre("transform without a view direction (1 camera)"));
}

TEST_F(LoadNode, ReadsPunctualLights) {
  builder_.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 10}, {"color", {1, 0.5, 0}}, {"range", 7}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "spot"}, {"spot", Json::object()}},
      {{"type", "directional"}, {"name", "sun"}, {"intensity", 3}}};
  nodes() = {{{"mesh", 0}}};
  for (int light = 0; light < 4; ++light) {
    nodes().push_back({{"translation", {light, 1, 2}},
                       {"rotation", {-kHalf, 0, 0, kHalf}},
                       {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
  const Scene scene = load();
  ASSERT_EQ(scene.lights.size(), 4u);
  const PunctualLight& point = scene.lights[0];
  EXPECT_EQ(point.kind, LightKind::Point);
  EXPECT_EQ(point.intensity, (Rgb{10, 5, 0}));
  EXPECT_EQ(point.range, 7);
  expect_near(point.position, {0, 1, 2});
  const PunctualLight& spot = scene.lights[1];
  EXPECT_EQ(spot.kind, LightKind::Spot);
  EXPECT_EQ(spot.inner_cone, 0.25f);
  EXPECT_EQ(spot.outer_cone, 0.5f);
  EXPECT_EQ(spot.intensity, (Rgb{1, 1, 1}));
  EXPECT_TRUE(std::isinf(spot.range));
  expect_near(spot.direction, {0, -1, 0});  // -z turned about x by minus a quarter
  EXPECT_NEAR(scene.lights[2].outer_cone, M_PI / 4, 1e-6);
  EXPECT_EQ(scene.lights[3].kind, LightKind::Directional);
  EXPECT_THAT(scene.light_groups, ElementsAre("light 0", "light 1", "light 2", "sun"));
  EXPECT_EQ(scene.lights[3].light_group, 3);
}

}  // namespace
}  // namespace lte::scene
