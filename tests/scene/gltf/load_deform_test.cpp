// Morph targets, skins and instancing: the pose that the specification gives a file at rest.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::first_primitive;
using test::GltfBuilder;
using test::Json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Triangle = std::array<uint32_t, 3>;

class LoadDeform : public test::GltfTest {
 protected:
  /// Expects an error for the file that `make` builds and `spoil` changes.
  void expect(const std::function<GltfBuilder()>& make,
              const std::function<void(GltfBuilder&)>& spoil, const std::string& element,
              const std::string& part) {
    GltfBuilder builder = make();
    spoil(builder);
    EXPECT_THAT(error(builder),
                AllOf(HasSubstr("scene.gltf: "), HasSubstr(element), HasSubstr(part)));
  }
};

/// The unit triangle; target 0 moves its second vertex by (0, 0, 4), target 1 all by (1, 0, 0).
GltfBuilder morphed() {
  GltfBuilder builder;
  Json item = builder.triangle();
  item["targets"] = {{{"POSITION", builder.floats({0, 0, 0, 0, 0, 4, 0, 0, 0})}},
                     {{"POSITION", builder.floats({1, 0, 0, 1, 0, 0, 1, 0, 0})}}};
  builder.mesh(item);
  return builder;
}

TEST_F(LoadDeform, TargetsWithoutWeightsHaveNoEffect) {
  GltfBuilder builder = morphed();
  const Scene scene = load(builder);
  EXPECT_THAT(scene.meshes[0].positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(scene.ignored, IsEmpty());
}

TEST_F(LoadDeform, MeshWeightsAreTheRestPose) {
  GltfBuilder builder = morphed();
  builder.json["meshes"][0]["weights"] = {0.25, 2};
  EXPECT_THAT(load(builder).meshes[0].positions,
              ElementsAre(Vec3{2, 0, 0}, Vec3{3, 0, 1}, Vec3{2, 1, 0}));
}

TEST_F(LoadDeform, NodeWeightsStandInForThoseOfTheMesh) {
  GltfBuilder builder = morphed();
  builder.json["meshes"][0]["weights"] = {0.25, 0};
  builder.json["nodes"] = {{{"mesh", 0}},
                           {{"mesh", 0}, {"weights", {0, -1}}},
                           {{"mesh", 0}, {"weights", {0, 0}}},
                           {{"mesh", 0}, {"translation", {0, 0, 9}}}};
  const Scene scene = load(builder);
  ASSERT_EQ(scene.meshes.size(), 3u) << "nodes that agree share a mesh";
  ASSERT_EQ(scene.instances.size(), 4u);
  const auto second = [&](size_t i) {
    return scene.meshes[static_cast<size_t>(scene.instances[i].mesh)].positions[1];
  };
  EXPECT_EQ(second(0), (Vec3{1, 0, 1}));
  EXPECT_EQ(second(1), (Vec3{0, 0, 0}));
  EXPECT_EQ(second(2), (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.instances[3].mesh, scene.instances[0].mesh);
}

TEST_F(LoadDeform, SparseAndQuantizedTargetsMoveUvAndColorsToo) {
  GltfBuilder builder = morphed();
  first_primitive(builder)["attributes"]["TEXCOORD_0"] = builder.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  first_primitive(builder)["attributes"]["COLOR_0"] =
      builder.floats({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f});
  const int uv =
      builder.accessor(std::vector<int8_t>{127, 0, -127, 0, 0, 127}, test::kByte, "VEC2", true);
  const int color = builder.floats({1, 0, 0, 0, 0, 0, 0, -1, 0});
  // A sparse displacement without a dense part: of vertex 2 alone.
  const int index = builder.view(std::vector<uint8_t>{2}),
            value = builder.view(std::vector<float>{0, 0, 1});
  builder.json["accessors"].push_back(
      {{"componentType", test::kFloat},
       {"count", 3},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", index}, {"componentType", test::kUnsignedByte}}},
         {"values", {{"bufferView", value}}}}}});
  first_primitive(builder)["targets"] = {
      {{"POSITION", builder.json["accessors"].size() - 1}, {"TEXCOORD_0", uv}, {"COLOR_0", color}}};
  builder.json["meshes"][0]["weights"] = {1};
  const Mesh mesh = load(builder).meshes[0];
  EXPECT_EQ(mesh.positions[2], (Vec3{0, 1, 1}));
  EXPECT_EQ(mesh.positions[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh.uvs[0][0].x, 1);
  EXPECT_EQ(mesh.uvs[0][1].x, 0);
  EXPECT_EQ(mesh.uvs[0][2].y, 2);
  EXPECT_EQ(mesh.colors[0], (Rgb{1, 0.5f, 0.5f})) << "clamped to 1";
  EXPECT_EQ(mesh.colors[2], (Rgb{0.5f, 0, 0.5f})) << "clamped to 0";
}

TEST_F(LoadDeform, MorphCountsThatDisagree) {
  expect(
      morphed, [](GltfBuilder& b) { b.json["meshes"][0]["weights"] = {1}; }, "meshes[0].weights",
      "array of 2 numbers");
  expect(
      morphed,
      [](GltfBuilder& b) {
        b.json["nodes"][0]["weights"] = {1, 2, 3};
      },
      "nodes[0].weights", "array of 2 numbers");
  expect(
      morphed,
      [](GltfBuilder& b) {
        b.json["nodes"].push_back({{"weights", {1}}});
      },
      "nodes[1]", "no mesh");
  expect(
      morphed, [](GltfBuilder& b) { b.json["meshes"][0]["primitives"].push_back(b.triangle()); },
      "meshes[0].primitives[1] has 0 morph targets", "primitives[0] has 2");
  expect(
      morphed,
      [](GltfBuilder& b) {
        first_primitive(b)["targets"][0]["POSITION"] = b.floats({1, 2, 3});
        b.json["meshes"][0]["weights"] = {1, 1};
      },
      "targets[0].POSITION has 1 elements", "3 vertices");
  expect(
      morphed, [](GltfBuilder& b) { first_primitive(b)["targets"][1]["POSITION"] = 50; },
      "targets[1].POSITION is 50", "accessors");
  expect(
      morphed, [](GltfBuilder& b) { first_primitive(b)["targets"] = 5; }, "targets", "array");
  expect(
      morphed,
      [](GltfBuilder& b) {
        b.json["meshes"][0]["weights"] = {3e38, 0};
      },
      "targets[0].POSITION: vertex 1", "not finite once displaced");
}

/// One skin of two joints over the unit triangle: vertex 0 hangs on joint 0, vertex 1 on joint 1,
/// vertex 2 on both by halves. Nodes: 0 the mesh, 1 and 2 the joints.
GltfBuilder skinned() {
  GltfBuilder builder;
  Json item = builder.triangle();
  item["attributes"]["JOINTS_0"] = builder.accessor(
      std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, test::kUnsignedByte, "VEC4");
  item["attributes"]["WEIGHTS_0"] =
      builder.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4");
  builder.mesh(item);
  builder.json["nodes"].push_back({{"translation", {0, 0, 10}}});
  builder.json["nodes"].push_back({{"scale", {3, 3, 3}}});
  builder.json["skins"] = {{{"joints", {1, 2}}}};
  builder.json["nodes"][0]["skin"] = 0;
  return builder;
}

TEST_F(LoadDeform, JointsPlaceTheVerticesAndTheNodeHasNoSay) {
  GltfBuilder builder = skinned();
  builder.json["nodes"][0]["translation"] = {500, 0, 0};
  const Scene scene = load(builder);
  EXPECT_THAT(scene.meshes[0].positions, ElementsAre(Vec3{0, 0, 10}, Vec3{3, 0, 0}, Vec3{0, 2, 5}));
  EXPECT_EQ(scene.instances[0].to_world.point({1, 2, 3}), (Vec3{1, 2, 3}));
  EXPECT_THAT(scene.ignored, IsEmpty());
}

TEST_F(LoadDeform, InverseBindMatricesComeFirst) {
  GltfBuilder builder = skinned();
  // The bind pose is the rest pose: each matrix undoes its joint, and the mesh stays as it is.
  const std::vector<float> undo{1, 0, 0, 0,   0,        1,        0, 0, 0, 0, 1,
                                0, 0, 0, -10, 1,        1 / 3.0f, 0, 0, 0, 0, 1 / 3.0f,
                                0, 0, 0, 0,   1 / 3.0f, 0,        0, 0, 0, 1};
  builder.json["accessors"].push_back({{"bufferView", builder.view(undo)},
                                       {"componentType", test::kFloat},
                                       {"count", 2},
                                       {"type", "MAT4"}});
  builder.json["skins"][0]["inverseBindMatrices"] = builder.json["accessors"].size() - 1;
  const std::vector<Vec3> positions = load(builder).meshes[0].positions;
  for (size_t i = 0; i < 3; ++i)
    EXPECT_LT(length(positions[i] - std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}[i]), 1e-6f);
}

TEST_F(LoadDeform, JointsFollowTheirOwnParents) {
  GltfBuilder builder = skinned();
  builder.json["nodes"].push_back({{"translation", {7, 0, 0}}, {"children", {1, 2}}});
  EXPECT_THAT(load(builder).meshes[0].positions,
              ElementsAre(Vec3{7, 0, 10}, Vec3{10, 0, 0}, Vec3{7, 2, 5}));
}

TEST_F(LoadDeform, MorphingComesBeforeSkinning) {
  GltfBuilder builder = skinned();
  first_primitive(builder)["targets"] = {
      {{"POSITION", builder.floats({0, 0, 0, 1, 0, 0, 0, 0, 0})}}};
  builder.json["meshes"][0]["weights"] = {1};
  EXPECT_EQ(load(builder).meshes[0].positions[1], (Vec3{6, 0, 0}));
}

TEST_F(LoadDeform, WeightsAreBroughtToASumOfOne) {
  GltfBuilder builder = skinned();
  first_primitive(builder)["attributes"]["WEIGHTS_0"] =
      builder.accessor(std::vector<uint8_t>{127, 0, 0, 0, 254, 0, 0, 0, 0, 0, 0, 0},
                       test::kUnsignedByte, "VEC4", true);
  EXPECT_THAT(load(builder).meshes[0].positions,
              ElementsAre(Vec3{0, 0, 10}, Vec3{3, 0, 0}, Vec3{0, 1, 10}))
      << "a vertex without weights hangs on the first joint";
}

TEST_F(LoadDeform, MoreThanFourInfluences) {
  GltfBuilder builder = skinned();
  Json& attributes = first_primitive(builder)["attributes"];
  attributes["JOINTS_1"] = builder.accessor(
      std::vector<uint16_t>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, test::kUnsignedShort, "VEC4");
  attributes["WEIGHTS_1"] = builder.floats({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  // vertex 2: a quarter joint 0, three quarters joint 1
  EXPECT_EQ(load(builder).meshes[0].positions[2], (Vec3{0, 2.5f, 2.5f}));
}

TEST_F(LoadDeform, MirroringJointsTurnTrianglesAround) {
  GltfBuilder builder = skinned();
  EXPECT_THAT(load(builder).meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  builder.json["nodes"][1]["scale"] = {-1, 1, 1};
  builder.json["nodes"][2]["scale"] = {-1, 1, 1};
  EXPECT_THAT(load(builder).meshes[0].triangles, ElementsAre(Triangle{0, 2, 1}));
}

TEST_F(LoadDeform, SkinOfAMeshWithoutJointsIsNoted) {
  GltfBuilder builder = skinned();
  first_primitive(builder)["attributes"].erase("WEIGHTS_0");
  builder.json["nodes"][0]["translation"] = {5, 0, 0};
  const Scene scene = load(builder);
  EXPECT_EQ(scene.instances[0].to_world.point({0, 0, 0}), (Vec3{5, 0, 0}));
  EXPECT_THAT(scene.ignored, ElementsAre("skin of a mesh without JOINTS_0 and WEIGHTS_0 (1 node)"));
}

TEST_F(LoadDeform, BrokenSkins) {
  expect(
      skinned,
      [](GltfBuilder& b) {
        first_primitive(b)["attributes"]["JOINTS_0"] = b.accessor(
            std::vector<uint8_t>{0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0}, test::kUnsignedByte, "VEC4");
      },
      "JOINTS_0: vertex 1 hangs on joint 2", "skin has 2");
  expect(
      skinned,
      [](GltfBuilder& b) {
        b.json["skins"][0]["joints"] = {1, 9};
      },
      "skins[0].joints[1] is 9", "3 nodes");
  expect(
      skinned, [](GltfBuilder& b) { b.json["skins"][0].erase("joints"); }, "skins[0]", "no joints");
  expect(
      skinned, [](GltfBuilder& b) { b.json["nodes"][0]["skin"] = 4; }, "nodes[0].skin is 4",
      "1 skins");
  expect(
      skinned,
      [](GltfBuilder& b) {
        b.json["scenes"] = {{{"nodes", {0, 1}}}};
      },
      "skins[0].joints[1] is nodes[2]", "not in the scene");
  expect(
      skinned, [](GltfBuilder& b) { b.json["skins"][0]["inverseBindMatrices"] = 0; },
      "skins[0].inverseBindMatrices", "MAT4");
  expect(
      skinned,
      [](GltfBuilder& b) {
        first_primitive(b)["attributes"]["WEIGHTS_0"] =
            b.floats({1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
      },
      "WEIGHTS_0: vertex 1", "weight -1");
  expect(
      skinned,
      [](GltfBuilder& b) {
        first_primitive(b)["attributes"]["JOINTS_0"] =
            first_primitive(b)["attributes"]["WEIGHTS_0"];
      },
      "JOINTS_0", "unsigned bytes or shorts");
  expect(
      skinned,
      [](GltfBuilder& b) {
        first_primitive(b)["attributes"]["WEIGHTS_0"] = b.floats({1, 0, 0, 0}, "VEC4");
      },
      "WEIGHTS_0 has 1 elements", "expected 3 of 4");
}

/// Two instances of the triangle below a node that lifts everything by 5.
GltfBuilder instanced() {
  GltfBuilder builder;
  builder.mesh(builder.triangle());
  builder.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const float half = std::sqrt(0.5f);
  builder.json["nodes"][0]["translation"] = {0, 0, 5};
  builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", builder.floats({1, 0, 0, 0, 1, 0})},
      {"ROTATION", builder.floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4")},
      {"SCALE", builder.floats({1, 1, 1, 2, 2, 2})}};
  return builder;
}

TEST_F(LoadDeform, PlacesEveryInstanceOfANode) {
  GltfBuilder builder = instanced();
  const Scene scene = load(builder);
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].to_world.point({1, 0, 0}), (Vec3{2, 0, 5}));
  // twice the size, a quarter turn about z, then (0, 1, 0), then the node
  EXPECT_LT(length(scene.instances[1].to_world.point({1, 0, 0}) - Vec3{0, 3, 5}), 1e-6f);
  EXPECT_THAT(scene.ignored, IsEmpty());
}

TEST_F(LoadDeform, BrokenInstancing) {
  const auto attributes = [](GltfBuilder& b) -> Json& {
    return b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  };
  expect(
      instanced,
      [&](GltfBuilder& b) {
        attributes(b)["SCALE"] = b.floats({1, 1, 1});
      },
      "nodes[0].EXT_mesh_gpu_instancing.SCALE has 1 elements", "another attribute 2");
  expect(
      instanced, [&](GltfBuilder& b) { attributes(b)["SCALE"] = 99; },
      "EXT_mesh_gpu_instancing.attributes.SCALE is 99", "accessors");
  expect(
      instanced,
      [&](GltfBuilder& b) {
        attributes(b) = {{"_ID", 0}};
      },
      "nodes[0].EXT_mesh_gpu_instancing", "none of TRANSLATION");
  expect(
      instanced,
      [&](GltfBuilder& b) {
        attributes(b)["ROTATION"] = b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4");
      },
      "ROTATION[1]", "zero quaternion");
  expect(
      instanced,
      [&](GltfBuilder& b) {
        attributes(b)["SCALE"] = b.floats({1, 1, 1, NAN, 1, 1});
      },
      "instance 1", "not finite");
}

}  // namespace
}  // namespace lte::scene
