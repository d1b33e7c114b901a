// KHR_draco_mesh_compression: data encoded by libdraco's own encoder must come back.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#pragma GCC diagnostic pop

#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kSide = 12;

/// A wavy sheet of 2 kSide² triangles with UV and byte colors, encoded.
struct Encoded {
  std::vector<char> bytes;
  uint32_t points = 0, triangles = 0;
  int position = 0, uv = 0, color = 0;
};

std::array<float, 3> point(int x, int y) {
  return {static_cast<float>(x), static_cast<float>(y), 0.25f * static_cast<float>((x * y) % 5)};
}

Encoded encode(int method, int quantization_bits) {
  draco::TriangleSoupMeshBuilder builder;
  constexpr int kFaces = 2 * kSide * kSide;
  builder.Start(kFaces);
  Encoded out;
  out.position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  out.uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  out.color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, true);
  int face = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const std::array<std::array<int, 2>, 4> corner{
          {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
      for (const auto& k : std::array<std::array<int, 3>, 2>{{{0, 1, 2}, {0, 2, 3}}}) {
        std::array<std::array<float, 3>, 3> p;
        std::array<std::array<float, 2>, 3> uv;
        std::array<std::array<uint8_t, 4>, 3> color;
        for (size_t i = 0; i < 3; ++i) {
          const auto [cx, cy] = corner[static_cast<size_t>(k[i])];
          p[i] = point(cx, cy);
          uv[i] = {static_cast<float>(cx) / kSide, static_cast<float>(cy) / kSide};
          color[i] = {static_cast<uint8_t>(20 * cx), static_cast<uint8_t>(20 * cy), 51, 255};
        }
        const draco::FaceIndex at(static_cast<uint32_t>(face++));
        builder.SetAttributeValuesForFace(out.position, at, &p[0], &p[1], &p[2]);
        builder.SetAttributeValuesForFace(out.uv, at, &uv[0], &uv[1], &uv[2]);
        builder.SetAttributeValuesForFace(out.color, at, &color[0], &color[1], &color[2]);
      }
    }
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  if (quantization_bits > 0) {
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, quantization_bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, quantization_bits);
  }
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  out.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  out.points = mesh->num_points();
  out.triangles = mesh->num_faces();
  return out;
}

class LoadDraco : public test::GltfTest {
 protected:
  /// Accessors: 0 position, 1 uv, 2 color, 3 indices, none of which has a buffer view.
  GltfBuilder compressed(const Encoded& data) {
    GltfBuilder builder;
    builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    builder.json["accessors"] = {
        {{"componentType", test::kFloat}, {"count", data.points}, {"type", "VEC3"}},
        {{"componentType", test::kFloat}, {"count", data.points}, {"type", "VEC2"}},
        {{"componentType", test::kUnsignedByte},
         {"count", data.points},
         {"type", "VEC4"},
         {"normalized", true}},
        {{"componentType", test::kUnsignedInt}, {"count", 3 * data.triangles}, {"type", "SCALAR"}}};
    const Json draco{
        {"bufferView", builder.view(data.bytes)},
        {"attributes",
         {{"POSITION", data.position}, {"TEXCOORD_0", data.uv}, {"COLOR_0", data.color}}}};
    builder.mesh({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"COLOR_0", 2}}},
                  {"indices", 3},
                  {"extensions", {{"KHR_draco_mesh_compression", draco}}}});
    return builder;
  }

  static Json& extension(GltfBuilder& builder) {
    return test::first_primitive(builder)["extensions"]["KHR_draco_mesh_compression"];
  }
};

/// Every triangle of the sheet must be there once, with the winding and the attributes it had.
void expect_sheet(const Scene& scene, float tolerance) {
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), size_t{2 * kSide * kSide});
  ASSERT_EQ(mesh.uvs[0].size(), mesh.positions.size());
  ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
  std::set<std::array<int, 3>> seen;
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> cells{};
    float signed_area = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 &p = mesh.positions[triangle[i]], &q = mesh.positions[triangle[(i + 1) % 3]];
      const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
      const std::array<float, 3> wanted = point(x, y);
      EXPECT_NEAR(p.x, wanted[0], tolerance);
      EXPECT_NEAR(p.y, wanted[1], tolerance);
      EXPECT_NEAR(p.z, wanted[2], tolerance);
      EXPECT_NEAR(mesh.uvs[0][triangle[i]].x, wanted[0] / kSide, tolerance);
      EXPECT_NEAR(mesh.uvs[0][triangle[i]].y, wanted[1] / kSide, tolerance);
      EXPECT_NEAR(mesh.colors[triangle[i]].x, 20 * x / 255.0f, 1e-6f);
      EXPECT_NEAR(mesh.colors[triangle[i]].y, 20 * y / 255.0f, 1e-6f);
      EXPECT_NEAR(mesh.colors[triangle[i]].z, 0.2f, 1e-6f);
      cells[i] = y * (kSide + 1) + x;
      signed_area += 0.5f * (p.x * q.y - q.x * p.y);
    }
    EXPECT_NEAR(signed_area, 0.5f, 10 * tolerance + 1e-5f);
    std::sort(cells.begin(), cells.end());
    EXPECT_TRUE(seen.insert(cells).second);
  }
}

TEST_F(LoadDraco, ReadsBothEncodings) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    GltfBuilder builder = compressed(encode(method, 0));
    const Scene scene = load(builder);
    expect_sheet(scene, 0);
    EXPECT_THAT(scene.ignored, ::testing::IsEmpty());
  }
}

TEST_F(LoadDraco, ReadsQuantizedAttributesWithinTheirStep) {
  GltfBuilder builder = compressed(encode(draco::MESH_EDGEBREAKER_ENCODING, 14));
  expect_sheet(load(builder), kSide / 16384.0f);
}

TEST_F(LoadDraco, MorphTargetsLieBesideTheCompressedData) {
  const Encoded data = encode(draco::MESH_SEQUENTIAL_ENCODING, 0);
  GltfBuilder builder = compressed(data);
  std::vector<float> deltas;
  for (uint32_t i = 0; i < data.points; ++i) deltas.insert(deltas.end(), {0, 0, 2});
  builder.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", builder.floats(deltas)}}};
  builder.json["meshes"][0]["weights"] = {0.5};
  Scene scene = load(builder);
  for (Vec3& p : scene.meshes[0].positions) p.z -= 1;
  expect_sheet(scene, 1e-6f);
}

TEST_F(LoadDraco, NamesWhatIsWrong) {
  const Encoded data = encode(draco::MESH_EDGEBREAKER_ENCODING, 11);
  const auto expect = [&](const std::function<void(GltfBuilder&)>& spoil, const std::string& part) {
    GltfBuilder builder = compressed(data);
    spoil(builder);
    EXPECT_THAT(error(builder), AllOf(HasSubstr("scene.gltf: meshes[0].primitives[0]"),
                                      HasSubstr("KHR_draco_mesh_compression"), HasSubstr(part)));
  };
  expect([](GltfBuilder& b) { extension(b)["bufferView"] = 9; }, "bufferView is 9");
  expect([](GltfBuilder& b) { extension(b).erase("attributes"); }, "no attributes");
  expect([](GltfBuilder& b) { extension(b)["attributes"]["POSITION"] = 77; },
         "POSITION is 77, but the data hold no such attribute");
  expect([](GltfBuilder& b) { b.json["accessors"][3]["count"] = 30; }, "room for 10");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["count"] = 5; }, "and 5");
  expect([](GltfBuilder& b) { b.json["accessors"][1]["type"] = "VEC4"; },
         "has 2 components, but its accessor 4");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["componentType"] = test::kByte; },
         "POSITION holds floats, but its accessor integers");
  expect([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0].erase("indices"); },
         "no indices");
  expect([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["mode"] = 5; }, "mode 5");
  expect([](GltfBuilder& b) { b.bytes.replace(0, 16, 16, 'x'); }, "not a Draco mesh");
}

TEST_F(LoadDraco, TruncationAndDamageAreErrorsOrHarmless) {
  int errors = 0;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const Encoded whole = encode(method, 11);
    uint64_t state = 7;
    for (int run = 0; run < 60; ++run) {
      Encoded data = whole;
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      if (run % 3 == 0) {
        data.bytes.resize((state >> 33) % data.bytes.size() + 1);
      } else {
        data.bytes[(state >> 33) % data.bytes.size()] = static_cast<char>(state >> 25);
      }
      GltfBuilder builder = compressed(data);
      try {
        load(builder);
      } catch (const Error& e) {
        EXPECT_THAT(e.what(), HasSubstr("scene.gltf: mesh"));
        ++errors;
      }
    }
  }
  EXPECT_GT(errors, 40);
}

TEST_F(LoadDraco, AFewBytesCannotPromiseMillionsOfTriangles) {
  // Header of a sequential mesh, then 400 million faces and a billion points as varints.
  const std::vector<uint8_t> header{'D',  'R',  'A',  'C',  'O',  2,    2,    1,    0,
                                    0,    0,    0x80, 0x88, 0xde, 0xbe, 0x01, 0x80, 0x94,
                                    0xeb, 0xdc, 0x03, 0,    0,    0,    0};
  Encoded data;
  data.bytes.assign(header.begin(), header.end());
  data.points = 2'000'000'000;
  data.triangles = 1'300'000'000;
  GltfBuilder builder = compressed(data);
  EXPECT_THAT(error(builder), HasSubstr("cannot be in 25 bytes"));
}

TEST_F(LoadDraco, CountsAgainstTheLimitOfCompressedData) {
  const Encoded data = encode(draco::MESH_SEQUENTIAL_ENCODING, 0);
  GltfBuilder builder = compressed(data);
  // Three indices of 4 bytes a triangle; position, uv and color are 12, 8 and 4 bytes.
  LoadLimits limits;
  limits.inflated_bytes = int64_t{data.triangles} * 12 + int64_t{data.points} * 24;
  EXPECT_EQ(load(builder, limits).meshes.size(), 1u);
  --limits.inflated_bytes;
  EXPECT_THAT(error(builder, limits),
              AllOf(HasSubstr("KHR_draco_mesh_compression: compressed data would take"),
                    HasSubstr("the limit \"inflated\"")));
}

}  // namespace
}  // namespace lte::scene
