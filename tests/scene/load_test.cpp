// Containers, primitives and accessors.
#include "lte/scene/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"
#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Triangle = std::array<uint32_t, 3>;

using Load = test::GltfTest;

void expect_unit_triangle(const Scene& scene) {
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(scene.meshes[0].positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST_F(Load, ReadsEveryContainer) {
  GltfBuilder builder;
  builder.mesh(builder.triangle());
  expect_unit_triangle(load(builder));
  EXPECT_EQ(load(builder).name, "scene");
  builder.save_external(dir_ / "scene.gltf", "the data.bin", "the%20data.bin");
  expect_unit_triangle(load_scene(dir_ / "scene.gltf"));
  test::write_text(dir_ / "scene.gltf", "\xEF\xBB\xBF" + builder.json.dump());  // a byte order mark
  expect_unit_triangle(load_scene(dir_ / "scene.gltf"));
  builder.save_glb(dir_ / "scene.glb");
  expect_unit_triangle(load_scene(dir_ / "scene.glb"));
  builder.save_glb(dir_ / "scene.gltf");  // content decides, not the name
  expect_unit_triangle(load_scene(dir_ / "scene.gltf"));
}

TEST_F(Load, MaterialsAreNeverMissing) {
  GltfBuilder builder;
  builder.mesh(builder.triangle());
  const Scene scene = load(builder);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{1, 1, 1}));
  EXPECT_FALSE(scene.materials[0].emissive());
  EXPECT_THAT(scene.ignored, ::testing::IsEmpty());
}

TEST_F(Load, DefaultMaterialComesAfterTheFiles) {
  GltfBuilder builder;
  builder.json["materials"] = {{{"name", "paint"}}};
  builder.mesh(builder.triangle());
  const Scene scene = load(builder);
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].name, "paint");
  EXPECT_EQ(scene.meshes[0].material, 1);
}

TEST_F(Load, ReadsIndicesOfEveryType) {
  const auto indexed = [&](auto sample, int type) {
    using T = decltype(sample);
    GltfBuilder builder;
    Json primitive = builder.triangle();
    primitive["indices"] = builder.accessor(std::vector<T>{2, 0, 1}, type, "SCALAR");
    builder.mesh(primitive);
    EXPECT_THAT(load(builder).meshes[0].triangles, ElementsAre(Triangle{2, 0, 1}))
        << "type " << type;
  };
  indexed(uint8_t{}, test::kUnsignedByte);
  indexed(uint16_t{}, test::kUnsignedShort);
  indexed(uint32_t{}, test::kUnsignedInt);
}

TEST_F(Load, AssemblesStripsAndFans) {
  GltfBuilder builder;
  const int positions = builder.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  for (const int mode : {5, 6})
    builder.mesh({{"attributes", {{"POSITION", positions}}}, {"mode", mode}});
  const Scene scene = load(builder);
  EXPECT_THAT(scene.meshes[0].triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}, Triangle{2, 3, 4}));
  EXPECT_THAT(scene.meshes[1].triangles,
              ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}, Triangle{3, 4, 0}));
}

TEST_F(Load, LeavesOutPointsAndLinesWithANote) {
  GltfBuilder builder;
  Json triangle = builder.triangle(), points = triangle, lines = triangle, loop = triangle;
  points["mode"] = 0;
  lines["mode"] = 1;
  loop["mode"] = 2;
  builder.json["meshes"] = {{{"primitives", {points, triangle, lines, loop}}}};
  builder.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = load(builder);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.ignored, ElementsAre("lines (2 primitives)", "points (1 primitive)"));
}

TEST_F(Load, StoresASharedMeshOnce) {
  GltfBuilder builder;
  builder.mesh(builder.triangle());
  builder.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  const Scene scene = load(builder);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.triangle_count(), 2);
  EXPECT_EQ(scene.bounds().high, (Vec3{6, 1, 0}));
}

TEST_F(Load, OnePrimitiveIsOneMesh) {
  GltfBuilder builder;
  const Json triangle = builder.triangle();
  builder.json["meshes"] = {{{"name", "chair"}, {"primitives", {triangle, triangle}}}};
  builder.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
  const Scene scene = load(builder);
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.meshes[1].name, "chair/1");
}

TEST_F(Load, LeavesOutMeshesThatNoNodePlaces) {
  GltfBuilder builder;
  builder.mesh(builder.triangle());
  builder.mesh(builder.triangle());
  builder.json["nodes"].erase(1);
  EXPECT_EQ(load(builder).meshes.size(), 1u);
}

TEST_F(Load, ReadsUvAndColorsOfEveryType) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  Json& attributes = primitive["attributes"];
  attributes["TEXCOORD_0"] = builder.floats({0, 0.25f, 0.5f, 1, -3, 7}, "VEC2");
  attributes["TEXCOORD_1"] = builder.accessor(std::vector<uint16_t>{0, 65535, 13107, 0, 0, 0},
                                              test::kUnsignedShort, "VEC2", true);
  attributes["COLOR_0"] =
      builder.accessor(std::vector<uint8_t>{255, 0, 51, 9, 0, 255, 0, 9, 102, 0, 0, 9},
                       test::kUnsignedByte, "VEC4", true);
  builder.mesh(primitive);
  Json second = builder.triangle();
  second["attributes"]["COLOR_0"] = builder.floats({1, 0.5f, 0.25f, 2, 0, 0, 0, 0, 0});
  second["attributes"]["TEXCOORD_0"] = builder.accessor(
      std::vector<uint8_t>{255, 0, 0, 51, 0, 0, 0, 0}, test::kUnsignedByte, "VEC2", true);
  builder.json["accessors"].back()["count"] = 3;
  builder.mesh(second);

  const Scene scene = load(builder);
  const Mesh& a = scene.meshes[0];
  EXPECT_EQ(a.uvs[0][2].x, -3);
  EXPECT_EQ(a.uvs[0][0].y, 0.25f);
  EXPECT_EQ(a.uvs[1][0].y, 1);
  EXPECT_NEAR(a.uvs[1][1].x, 0.2, 1e-7);
  EXPECT_NEAR(a.colors[0].z, 0.2, 1e-7);
  EXPECT_NEAR(a.colors[2].x, 0.4, 1e-7);
  const Mesh& b = scene.meshes[1];
  EXPECT_EQ(b.colors[0], (Rgb{1, 0.5f, 0.25f}));
  EXPECT_EQ(b.colors[1].x, 2) << "kept as it is; albedo is clamped, colors are not";
  EXPECT_NEAR(b.uvs[0][1].y, 0.2, 1e-7);
}

TEST_F(Load, ReadsSignedNormalizedShorts) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  primitive["attributes"]["TEXCOORD_0"] = builder.accessor(
      std::vector<int16_t>{32767, -32767, -32768, 0, 0, 0}, test::kShort, "VEC2", true);
  builder.mesh(primitive);
  const Mesh mesh = load(builder).meshes[0];
  EXPECT_EQ(mesh.uvs[0][0].x, 1);
  EXPECT_EQ(mesh.uvs[0][0].y, -1);
  EXPECT_EQ(mesh.uvs[0][1].x, -1) << "the most negative code is clamped";
}

TEST_F(Load, ReadsQuantizedPositions) {
  GltfBuilder builder;
  const int view =
      builder.view(std::vector<int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}, 8);
  builder.json["accessors"] = {{{"bufferView", view},
                                {"componentType", 5122},
                                {"normalized", true},
                                {"count", 3},
                                {"type", "VEC3"}}};
  builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.mesh({{"attributes", {{"POSITION", 0}}}});
  expect_unit_triangle(load(builder));
}

TEST_F(Load, FollowsStridesAndOffsets) {
  // Interleaved position and uv, 20 bytes a vertex, after 4 bytes of something else.
  GltfBuilder builder;
  const int view =
      builder.view(std::vector<float>{99, 0, 0, 0, 0.5f, 0.25f, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 20);
  builder.json["accessors"] = {{{"bufferView", view},
                                {"byteOffset", 4},
                                {"componentType", 5126},
                                {"count", 3},
                                {"type", "VEC3"}},
                               {{"bufferView", view},
                                {"byteOffset", 16},
                                {"componentType", 5126},
                                {"count", 3},
                                {"type", "VEC2"}}};
  builder.mesh({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}});
  const Scene scene = load(builder);
  expect_unit_triangle(scene);
  EXPECT_EQ(scene.meshes[0].uvs[0][0].x, 0.5f);
  EXPECT_EQ(scene.meshes[0].uvs[0][1].x, 1.0f);
  EXPECT_EQ(scene.meshes[0].uvs[0][2].y, 1.0f);
}

TEST_F(Load, AppliesSparseAccessors) {
  GltfBuilder builder;
  const int positions = builder.floats({0, 0, 0, 1, 0, 0, 7, 7, 7});
  const int indices = builder.view(std::vector<uint8_t>{2});
  const int values = builder.view(std::vector<float>{0, 1, 0});
  builder.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  builder.mesh({{"attributes", {{"POSITION", positions}}}});
  expect_unit_triangle(load(builder));
}

TEST_F(Load, SparseWithoutAViewStartsFromZeros) {
  GltfBuilder builder;
  const int indices = builder.view(std::vector<uint16_t>{1, 2});
  const int values = builder.view(std::vector<float>{1, 0, 0, 0, 1, 0});
  builder.json["accessors"] = {{{"componentType", 5126},
                                {"count", 3},
                                {"type", "VEC3"},
                                {"sparse",
                                 {{"count", 2},
                                  {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                  {"values", {{"bufferView", values}}}}}}};
  builder.mesh({{"attributes", {{"POSITION", 0}}}});
  expect_unit_triangle(load(builder));
}

TEST_F(Load, ReadsIndicesThatAreSparseAlone) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  const int at = builder.view(std::vector<uint8_t>{1, 2}),
            values = builder.view(std::vector<uint16_t>{1, 2});
  builder.json["accessors"].push_back(
      {{"componentType", test::kUnsignedShort},
       {"count", 3},
       {"type", "SCALAR"},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", at}, {"componentType", test::kUnsignedByte}}},
         {"values", {{"bufferView", values}}}}}});
  primitive["indices"] = builder.json["accessors"].size() - 1;
  builder.mesh(primitive);
  expect_unit_triangle(load(builder));
}

TEST_F(Load, KeepsOnlyTheVerticesThatAPrimitiveUses) {
  GltfBuilder builder;
  std::vector<float> values;
  for (int i = 0; i < 100; ++i)
    values.insert(values.end(), {static_cast<float>(i), 0, static_cast<float>(i % 2)});
  const int positions = builder.floats(values), colors = builder.floats(values);
  const Json attributes{{"POSITION", positions}, {"COLOR_0", colors}};
  builder.mesh(
      {{"attributes", attributes},
       {"indices", builder.accessor(std::vector<uint8_t>{90, 3, 40, 40, 3, 7}, 5121, "SCALAR")}});
  builder.mesh({{"attributes", attributes},
                {"indices", builder.accessor(std::vector<uint8_t>{3, 90, 91}, 5121, "SCALAR")}});
  const Scene scene = load(builder);
  EXPECT_THAT(scene.meshes[0].positions,
              ElementsAre(Vec3{90, 0, 0}, Vec3{3, 0, 1}, Vec3{40, 0, 0}, Vec3{7, 0, 1}));
  EXPECT_EQ(scene.meshes[0].colors, scene.meshes[0].positions);
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}));
  EXPECT_THAT(scene.meshes[1].positions,
              ElementsAre(Vec3{3, 0, 1}, Vec3{90, 0, 0}, Vec3{91, 0, 1}));
}

TEST_F(Load, KeepsDegenerateTriangles) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  primitive["indices"] =
      builder.accessor(std::vector<uint8_t>{0, 1, 2, 1, 1, 1, 0, 2}, 5121, "SCALAR");
  builder.mesh(primitive);
  const Scene scene = load(builder);
  ASSERT_EQ(scene.triangle_count(), 2);
  EXPECT_EQ(area(world_triangle(scene.meshes[0], {}, 1)), 0);
  EXPECT_EQ(evaluate_surface(scene, 0, 1, 0.3f, 0.3f, 0.1f).normal, (Vec3{0, 0, 0}));
  EXPECT_THAT(scene.ignored, ElementsAre("incomplete triangle (1 primitive)"));
}

TEST_F(Load, NotesWhatItLeavesOut) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  primitive["extensions"] = {{"KHR_materials_variants", {{"mappings", Json::array()}}}};
  primitive["material"] = 0;
  builder.mesh(primitive);
  builder.json["extensionsUsed"] = {"KHR_materials_sheen", "KHR_materials_variants",
                                    "EXT_something"};
  builder.json["extensions"] = {{"EXT_something", Json::object()}};
  builder.json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  builder.json["images"] = {{{"uri", "absent.png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["materials"] = {
      {{"alphaMode", "MASK"},
       {"extensions", {{"KHR_materials_sheen", Json::object()}}},
       {"normalTexture", {{"index", 0}}},
       {"occlusionTexture", {{"index", 0}}},
       {"pbrMetallicRoughness",
        {{"metallicFactor", 0}, {"metallicRoughnessTexture", {{"index", 0}}}}}},
      {{"extensions", {{"KHR_materials_sheen", Json::object()}}}}};
  EXPECT_THAT(
      load(builder).ignored,
      ElementsAre("KHR_materials_sheen: dropped sheen (2 materials)",
                  "KHR_materials_variants: dropped material variants (the default one is kept) "
                  "(1 primitive)",
                  "alphaMode MASK (1 material)", "animations (1 animation)",
                  "extension EXT_something (1 file)",
                  "metallic-roughness texture without metallicFactor (1 material)",
                  "occlusion texture (1 material)",
                  "picture of a normal map that is not there "
                  "(1 image)"));
}

TEST_F(Load, TakesFilesThatRequireAppearanceItDrops) {
  GltfBuilder builder;
  Json primitive = builder.triangle();
  primitive["material"] = 0;
  builder.mesh(primitive);
  const std::vector<std::string> names{"KHR_materials_clearcoat", "KHR_materials_ior",
                                       "KHR_materials_specular",  "KHR_materials_transmission",
                                       "KHR_materials_unlit",     "KHR_materials_volume"};
  for (const std::string& name : names) {
    builder.json["extensionsRequired"].push_back(name);
    builder.json["materials"][0]["extensions"][name] = Json::object();
  }
  builder.json["materials"].push_back(builder.json["materials"][0]);
  const Scene scene = load(builder);
  ASSERT_EQ(scene.ignored.size(), names.size())
      << "one line each, whatever the number of materials";
  for (size_t i = 0; i < names.size(); ++i) {
    EXPECT_THAT(scene.ignored[i], HasSubstr(names[i] + ": dropped "));
    EXPECT_THAT(scene.ignored[i], HasSubstr("(2 materials)"));
  }
  builder.json["extensionsRequired"].push_back("EXT_meshopt_compression");
  EXPECT_THAT(test::error_of([&] { load(builder); }), HasSubstr("EXT_meshopt_compression"));
}

TEST_F(Load, ReadsQuantizedAttributesOfEveryKind) {
  // KHR_mesh_quantization: positions as normalized and plain bytes and shorts, padded to 4 bytes.
  GltfBuilder builder;
  builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto add = [&](const Json& position) {
    builder.json["accessors"].push_back(position);
    builder.mesh({{"attributes", {{"POSITION", builder.json["accessors"].size() - 1}}}});
  };
  const int bytes =
      builder.view(std::vector<int8_t>{127, -127, 0, 9, -128, 64, 1, 9, 0, 0, 0, 9}, 4);
  const int shorts =
      builder.view(std::vector<uint16_t>{65535, 0, 13107, 9, 1, 2, 3, 9, 0, 0, 0, 9}, 8);
  for (const bool normalized : {true, false}) {
    add({{"bufferView", bytes},
         {"componentType", test::kByte},
         {"count", 3},
         {"type", "VEC3"},
         {"normalized", normalized}});
    add({{"bufferView", shorts},
         {"componentType", test::kUnsignedShort},
         {"count", 3},
         {"type", "VEC3"},
         {"normalized", normalized}});
  }
  const Scene scene = load(builder);
  EXPECT_EQ(scene.meshes[0].positions[0], (Vec3{1, -1, 0}));
  EXPECT_EQ(scene.meshes[0].positions[1], (Vec3{-1, 64 / 127.0f, 1 / 127.0f}));
  EXPECT_EQ(scene.meshes[1].positions[0].x, 1);
  EXPECT_NEAR(scene.meshes[1].positions[0].z, 0.2, 1e-7);
  EXPECT_EQ(scene.meshes[2].positions[1], (Vec3{-128, 64, 1}));
  EXPECT_EQ(scene.meshes[3].positions[0], (Vec3{65535, 0, 13107}));
}

TEST_F(Load, ReadsMillionsOfTriangles) {
  // A 1000 x 1000 grid: 2 million triangles, 24 MB of indices, and not a second of anyone's time.
  constexpr uint32_t kSide = 1001;
  GltfBuilder builder;
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), 0});
      if (x + 1 == kSide || y + 1 == kSide) continue;
      const uint32_t i = y * kSide + x;
      indices.insert(indices.end(), {i, i + 1, i + kSide, i + 1, i + kSide + 1, i + kSide});
    }
  }
  const int vertices = builder.floats(positions);
  builder.mesh({{"attributes", {{"POSITION", vertices}}},
                {"indices", builder.accessor(indices, 5125, "SCALAR")}});
  builder.save_glb(dir_ / "grid.glb");
  const Scene scene = load_scene(dir_ / "grid.glb");
  EXPECT_EQ(scene.triangle_count(), 2'000'000);
  EXPECT_EQ(scene.meshes[0].positions.size(), static_cast<size_t>(kSide) * kSide);
  EXPECT_EQ(scene.bounds().high, (Vec3{1000, 1000, 0}));
}

}  // namespace
}  // namespace lte::scene
