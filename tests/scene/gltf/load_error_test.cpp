// Hostile and broken files: one clear line each, naming file and element, and no crash.
#include <cstring>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/scene/load.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class LoadError : public ::testing::Test {
 protected:
  std::string error(const std::string& name, const LoadLimits& limits = {}) {
    return test::error_of([&] { load_scene(dir_ / name, limits); });
  }

  /// The error for a small valid scene after `spoil` has changed it.
  std::string spoiled(const std::function<void(GltfBuilder&)>& spoil,
                      const LoadLimits& limits = {}) {
    GltfBuilder builder = valid();
    spoil(builder);
    builder.save_embedded(dir_ / "bad.gltf");
    return error("bad.gltf", limits);
  }

  /// Expects the message to name the file and `parts`.
  void expect(const std::function<void(GltfBuilder&)>& spoil, const std::string& element,
              const std::string& part) {
    EXPECT_THAT(spoiled(spoil),
                AllOf(HasSubstr("bad.gltf: "), HasSubstr(element), HasSubstr(part)));
  }

  /// Accessors: 0 position, 1 indices, 2 uv. One material with one texture, one node.
  static GltfBuilder valid() {
    GltfBuilder builder;
    Json primitive = builder.triangle();
    primitive["indices"] =
        builder.accessor(std::vector<uint16_t>{0, 1, 2}, test::kUnsignedShort, "SCALAR");
    primitive["attributes"]["TEXCOORD_0"] = builder.floats({0, 0, 1, 0, 0, 1}, "VEC2");
    primitive["material"] = 0;
    builder.mesh(primitive);
    builder.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.json["textures"] = {{{"source", 0}}};
    // 1x1 gray PNG, 8 bit
    const std::vector<uint8_t> png{0x89, 'P', 'N',  'G',  13,   10,   26,   10,   0,    0, 0, 13,
                                   'I',  'H', 'D',  'R',  0,    0,    0,    1,    0,    0, 0, 1,
                                   8,    0,   0,    0,    0,    0x3a, 0x7e, 0x9b, 0x55, 0, 0, 0,
                                   10,   'I', 'D',  'A',  'T',  0x78, 0x9c, 0x63, 0x68, 0, 0, 0,
                                   0x82, 0,   0x81, 0x77, 0xcd, 0x72, 0xb6, 0,    0,    0, 0, 'I',
                                   'E',  'N', 'D',  0xae, 0x42, 0x60, 0x82};
    builder.json["images"] = {{{"bufferView", builder.view(png)}}};
    return builder;
  }

  static Json& primitive(GltfBuilder& builder) {
    return builder.json["meshes"][0]["primitives"][0];
  }

  test::TempDir dir_;
};

TEST_F(LoadError, StartsFromAValidScene) {
  GltfBuilder builder = valid();
  builder.save_embedded(dir_ / "good.gltf");
  EXPECT_EQ(load_scene(dir_ / "good.gltf").textures.size(), 1u);
}

TEST_F(LoadError, FilesThatAreNoScene) {
  EXPECT_THAT(error("none.glb"), HasSubstr("none.glb: no such file"));
  EXPECT_THAT(test::error_of([&] { load_scene(dir_.path()); }), HasSubstr("is a directory"));
  test::write_text(dir_ / "empty.glb", "");
  EXPECT_THAT(error("empty.glb"), HasSubstr("empty"));
  test::write_text(dir_ / "noise.glb", "\x01\x02garbage");
  EXPECT_THAT(error("noise.glb"), HasSubstr("not a glTF file"));
  test::write_text(dir_ / "cut.gltf", R"({"asset":{"version":)");
  EXPECT_THAT(error("cut.gltf"), AllOf(HasSubstr("cut.gltf: not valid JSON"), HasSubstr("line 1")));
  test::write_text(dir_ / "other.gltf", R"({"hello":1})");
  EXPECT_THAT(error("other.gltf"), HasSubstr("no \"asset\""));
  test::write_text(dir_ / "old.gltf", R"({"asset":{"version":"1.0"}})");
  EXPECT_THAT(error("old.gltf"), HasSubstr("version \"1.0\""));
  test::write_text(dir_ / "array.gltf", R"({"asset":{"version":"2.0"},"meshes":{}})");
  EXPECT_THAT(error("array.gltf"), HasSubstr("meshes must be an array"));
}

TEST_F(LoadError, UnknownFormatsGetTheListOfKnownOnes) {
  const std::string known =
      "unknown scene format: expected one of .gltf, .glb, .pbrt, .pbrt.gz, .obj, .ply, .ply.gz";
  for (const char* name : {"room.fbx", "room", "room.glb.bak", "room.obj.gz", "gltf"}) {
    EXPECT_THAT(error(name), EndsWith(concat(name, ": ", known)));  // whether it is there or not
    test::write_text(dir_ / name, "{}");
    EXPECT_THAT(error(name), EndsWith(concat(name, ": ", known)));
  }
}

TEST_F(LoadError, CaseOfTheExtensionDoesNotMatter) {
  GltfBuilder builder = valid();
  builder.save_embedded(dir_ / "Room.GLTF");
  EXPECT_EQ(load_scene(dir_ / "Room.GLTF").name, "Room");
}

TEST_F(LoadError, EveryTruncationOfAGlb) {
  GltfBuilder builder = valid();
  const std::string whole = builder.glb();
  for (size_t size = 1; size < whole.size(); size += size < 40 ? 1 : 37) {
    test::write_text(dir_ / "cut.glb", whole.substr(0, size));
    EXPECT_THAT(error("cut.glb"), HasSubstr("cut.glb: ")) << size;
  }
}

TEST_F(LoadError, LyingGlbHeaders) {
  GltfBuilder builder = valid();
  const std::string whole = builder.glb();
  const auto patched = [&](size_t offset, uint32_t value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + offset, &value, 4);
    test::write_text(dir_ / "lie.glb", bytes);
    return error("lie.glb");
  };
  uint32_t json_size = 0;
  std::memcpy(&json_size, whole.data() + 12, 4);
  EXPECT_THAT(patched(4, 1), HasSubstr("version 1"));
  EXPECT_THAT(patched(8, 0xffffffff), HasSubstr("truncated .glb"));
  EXPECT_THAT(patched(8, 12), HasSubstr("impossible length"));
  EXPECT_THAT(patched(12, 0xfffffff0), HasSubstr("truncated .glb, chunk 0"));
  EXPECT_THAT(patched(16, 0), HasSubstr("first chunk"));
  EXPECT_THAT(patched(20 + json_size, 0x7fffffff), HasSubstr("truncated .glb, chunk 1"));
  // 8 more than there is: the length that tinygltf's own check lets through
  uint32_t bin_size = 0;
  std::memcpy(&bin_size, whole.data() + 20 + json_size, 4);
  EXPECT_THAT(patched(20 + json_size, bin_size + 8), HasSubstr("truncated .glb, chunk 1"));
  EXPECT_THAT(patched(24 + json_size, 7), HasSubstr("no BIN chunk"));
}

TEST_F(LoadError, RandomDamageNeverCrashes) {
  GltfBuilder builder = valid();
  const std::string whole = builder.glb();
  uint64_t state = 42;
  int errors = 0;
  for (int run = 0; run < 1000; ++run) {
    std::string bytes = whole;
    for (int k = 0; k < 3; ++k) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      bytes[(state >> 33) % bytes.size()] = static_cast<char>(state >> 25);
    }
    test::write_text(dir_ / "noise.glb", bytes);
    try {
      load_scene(dir_ / "noise.glb");
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 250);
}

TEST_F(LoadError, IndicesPastTheEnd) {
  expect(
      [](GltfBuilder& b) {
        b.json["scenes"] = {{{"nodes", {5}}}};
      },
      "scenes[0].nodes[0] is 5", "1 nodes");
  expect([](GltfBuilder& b) { b.json["scene"] = 0; }, "scene is 0", "0 scenes");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["mesh"] = 1; }, "nodes[0].mesh is 1", "1 meshes");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["mesh"] = -1; }, "nodes[0].mesh is -1",
         "1 meshes");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["mesh"] = 4294967296; }, "nodes[0].mesh",
         "1 meshes");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["camera"] = 0; }, "nodes[0].camera", "0 cameras");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["children"] = {9}; }, "nodes[0].children[0] is 9",
         "1 nodes");
  expect(
      [](GltfBuilder& b) { b.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
      "nodes[0]", "0 lights");
  expect([](GltfBuilder& b) { primitive(b)["attributes"]["POSITION"] = 77; },
         "primitives[0].attributes.POSITION is 77", "3 accessors");
  expect([](GltfBuilder& b) { primitive(b)["indices"] = 3; }, "primitives[0].indices",
         "3 accessors");
  expect([](GltfBuilder& b) { primitive(b)["material"] = 1; }, "primitives[0].material",
         "1 materials");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["bufferView"] = 44; },
         "accessors[0].bufferView", "bufferViews");
  expect([](GltfBuilder& b) { b.json["bufferViews"][1]["buffer"] = 1; }, "bufferViews[1].buffer",
         "1 buffers");
  expect([](GltfBuilder& b) { b.json["textures"][0]["source"] = 1; }, "textures[0].source",
         "1 images");
  expect([](GltfBuilder& b) { b.json["textures"][0]["sampler"] = 0; }, "textures[0].sampler",
         "0 samplers");
  expect([](GltfBuilder& b) { b.json["images"][0]["bufferView"] = 10; }, "images[0].bufferView",
         "bufferViews");
  expect(
      [](GltfBuilder& b) {
        b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 2;
      },
      "materials[0].pbrMetallicRoughness.baseColorTexture.index is 2", "1 textures");
  expect([](GltfBuilder& b) { b.json["materials"][0]["emissiveTexture"]["index"] = 2; },
         "materials[0].emissiveTexture", "1 textures");
}

TEST_F(LoadError, VertexIndicesPastTheEnd) {
  const std::string message = spoiled([](GltfBuilder& b) {
    primitive(b)["indices"] =
        b.accessor(std::vector<uint8_t>{0, 1, 2, 2, 3, 0}, test::kUnsignedByte, "SCALAR");
  });
  EXPECT_THAT(message,
              HasSubstr("meshes[0].primitives[0]: index 4 is 3, but there are 3 vertices"));
}

TEST_F(LoadError, ElementsOutsideTheirBytes) {
  expect([](GltfBuilder& b) { b.json["accessors"][0]["count"] = 4; }, "POSITION",
         "do not fit into a buffer view of 36");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["count"] = 1'000'000'000'000; }, "POSITION",
         "do not fit into a buffer view of 36");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["count"] = 1e18; }, "accessors[0].count",
         "integer");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["count"] = -3; }, "accessors[0].count",
         "integer");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["byteOffset"] = 4; }, "POSITION",
         "do not fit into a buffer view of 36");
  expect(
      [](GltfBuilder& b) {
        b.json["accessors"][0].erase("bufferView");
        b.json["accessors"][0]["count"] = 1 << 30;
      },
      "POSITION", "without bufferView");
  expect([](GltfBuilder& b) { b.json["bufferViews"][0]["byteLength"] = 1'000'000; },
         "bufferViews[0]", "1000000");
  expect([](GltfBuilder& b) { b.json["bufferViews"][0]["byteOffset"] = 9'000'000'000'000'000; },
         "bufferViews[0]", "of a buffer");
  expect([](GltfBuilder& b) { b.json["bufferViews"][0]["byteStride"] = 8; }, "POSITION",
         "byteStride 8");
  expect([](GltfBuilder& b) { b.json["bufferViews"][0]["byteStride"] = 1000; },
         "bufferViews[0].byteStride", "252");
  expect([](GltfBuilder& b) { b.json["accessors"][2]["count"] = 2; }, "TEXCOORD_0",
         "has 2 elements");
}

TEST_F(LoadError, SparseIndicesPastTheEnd) {
  const auto sparse = [](uint8_t index, int count) {
    return [=](GltfBuilder& b) {
      const int indices = b.view(std::vector<uint8_t>{index}),
                values = b.view(std::vector<float>{1, 2, 3});
      b.json["accessors"][0]["sparse"] = {
          {"count", count},
          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
          {"values", {{"bufferView", values}}}};
    };
  };
  expect(sparse(3, 1), "POSITION", "sparse index 0 is 3");
  expect(sparse(0, 3), "POSITION", "do not fit into a buffer view of 1 bytes");
  expect(
      [&](GltfBuilder& b) {
        sparse(0, 1)(b);
        b.json["accessors"][0]["sparse"]["values"]["byteOffset"] = 4294967292;
      },
      "POSITION", "do not fit");
  expect(sparse(0, 4), "accessors[0].sparse", "exceeds");
}

TEST_F(LoadError, BuffersThatAreNotThere) {
  GltfBuilder builder = valid();
  builder.save_external(dir_ / "far.gltf", "data.bin", "gone.bin");
  EXPECT_THAT(error("far.gltf"), AllOf(HasSubstr("buffers[0]"), HasSubstr("gone.bin")));
  builder.save_external(dir_ / "far.gltf", "data.bin", "https://example.org/data.bin");
  EXPECT_THAT(error("far.gltf"), HasSubstr("not relative"));
  builder.save_external(dir_ / "far.gltf", "data.bin", "/dev/zero");
  EXPECT_THAT(error("far.gltf"), HasSubstr("not relative"));
  builder.save_external(dir_ / "far.gltf", "data.bin", ".");
  EXPECT_THAT(error("far.gltf"), HasSubstr("buffers[0]: \".\" is not a regular file"));
  builder.save_external(dir_ / "far.gltf", "data.bin", "data.bin");
  test::write_text(dir_ / "data.bin", "short");
  EXPECT_THAT(error("far.gltf"), AllOf(HasSubstr("buffers[0] is truncated"), HasSubstr("5 bytes")));
  builder.json["buffers"] = {{{"byteLength", 3}, {"uri", "data:;base64,$$$$"}}};
  test::write_text(dir_ / "far.gltf", builder.json.dump());
  EXPECT_THAT(error("far.gltf"), HasSubstr("not base64"));
}

TEST_F(LoadError, ValuesThatAreNotFinite) {
  for (const float value :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    expect(
        [&](GltfBuilder& b) {
          primitive(b)["attributes"]["POSITION"] = b.floats({0, 0, 0, 1, value, 0, 0, 1, 0});
        },
        "meshes[0].primitives[0].POSITION", "vertex 1 is not finite");
    expect(
        [&](GltfBuilder& b) {
          primitive(b)["attributes"]["TEXCOORD_0"] = b.floats({0, 0, 0, 0, 0, value}, "VEC2");
        },
        "TEXCOORD_0", "vertex 2 is not finite");
  }
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"][0]["translation"] = {0, 1e39, 0};
      },
      "nodes[0].translation[1]", "finite");
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"][0]["scale"] = {3e38, 1, 1};
        primitive(b)["attributes"]["POSITION"] = b.floats({0, 0, 0, 9, 0, 0, 0, 1, 0});
      },
      "mesh 0", "vertex 1 lies at (inf, 0, 0)");
  expect(
      [](GltfBuilder& b) {
        b.json["materials"][0]["emissiveFactor"] = {1, 1, -1};
      },
      "materials[0].emissiveFactor", "negative");
  expect(
      [](GltfBuilder& b) {
        b.json["materials"][0]["emissiveFactor"] = {3e38, 1, 1};
        b.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]
              ["emissiveStrength"] = 9;
      },
      "materials[0]", "not finite");
}

TEST_F(LoadError, IllTypedMembers) {
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"][0]["matrix"] = {1, 2, 3};
      },
      "nodes[0].matrix", "16 numbers");
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
      },
      "nodes[0].rotation", "zero quaternion");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["scale"] = "big"; }, "nodes[0].scale",
         "3 numbers");
  expect([](GltfBuilder& b) { b.json["nodes"][0]["matrix"] = Json(std::vector<int>(16, 1)); },
         "nodes[0].matrix", "affine");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["type"] = "VEC9"; }, "accessors[0].type",
         "unknown");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["type"] = "VEC2"; }, "POSITION",
         "2 components, expected 3");
  expect(
      [](GltfBuilder& b) {
        b.json["accessors"][0]["type"] = "MAT4";
        b.json["accessors"][0]["count"] = 0;
      },
      "POSITION", "matrix");
  expect([](GltfBuilder& b) { b.json["accessors"][0]["componentType"] = 5124; },
         "accessors[0].componentType", "5124");
  expect([](GltfBuilder& b) { b.json["accessors"][1]["componentType"] = test::kShort; }, "indices",
         "unsigned");
  expect([](GltfBuilder& b) { primitive(b).erase("attributes"); }, "meshes[0].primitives[0]",
         "no attributes");
  expect([](GltfBuilder& b) { primitive(b)["mode"] = 7; }, "meshes[0].primitives[0].mode",
         "0 to 6");
  expect([](GltfBuilder& b) { b.json["nodes"] = {5}; }, "nodes[0]", "must be an object");
  expect([](GltfBuilder& b) { b.json["materials"][0]["name"] = 5; }, "materials[0].name", "string");
  expect([](GltfBuilder& b) { b.json["materials"][0]["pbrMetallicRoughness"] = 5; },
         "pbrMetallicRoughness", "object");
  expect(
      [](GltfBuilder& b) {
        b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "moon"}}};
      },
      "extensions.KHR_lights_punctual.lights[0].type", "point, spot or directional");
  expect(
      [](GltfBuilder& b) {
        b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 4}}}}};
      },
      "cameras[0].perspective.yfov", "between 0 and pi");
}

TEST_F(LoadError, RequiredExtensionsThatWeLack) {
  expect(
      [](GltfBuilder& b) {
        b.json["extensionsRequired"] = {"KHR_texture_transform", "EXT_meshopt_compression"};
      },
      "requires extension EXT_meshopt_compression", "lte lacks");
}

TEST_F(LoadError, NodesThatAreNoTree) {
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
      },
      "every node has a parent", "cyclic");
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}};
      },
      "nodes[1]", "its own ancestor");
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"] = {{{"children", {0}}}};
        b.json["scenes"] = {{{"nodes", {0}}}};
      },
      "nodes[0]", "its own ancestor");
  expect(
      [](GltfBuilder& b) {
        b.json["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
      },
      "nodes[1]", "more than one parent");
}

TEST_F(LoadError, TooDeepNodesAndJson) {
  const auto chain = [](GltfBuilder& b) {
    b.json["nodes"] = Json::array();
    for (int i = 0; i < 2000; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
    b.json["nodes"].push_back({{"mesh", 0}});
  };
  expect(chain, "nodes[1024]", "deeper than 1024");
  const std::string deep = R"({"asset":{"version":"2.0","extras":)" + std::string(200000, '[');
  test::write_text(dir_ / "deep.gltf", deep + std::string(200000, ']') + "}}");
  EXPECT_THAT(error("deep.gltf"), HasSubstr("nested deeper than 128"));
}

TEST_F(LoadError, ScenesWithoutTriangles) {
  expect([](GltfBuilder& b) { b.json.erase("nodes"); }, "", "no triangles");
  expect([](GltfBuilder& b) { b.json["nodes"][0].erase("mesh"); }, "", "no triangles");
  expect([](GltfBuilder& b) { primitive(b)["mode"] = 0; }, "", "no triangles");
  expect([](GltfBuilder& b) { primitive(b)["attributes"].erase("POSITION"); }, "", "no triangles");
}

TEST_F(LoadError, CapsOnTriangles) {
  LoadLimits limits;
  limits.triangles = 1;
  const auto twice = [](GltfBuilder& b) { b.json["nodes"].push_back({{"mesh", 0}}); };
  EXPECT_THAT(spoiled(twice, limits),
              AllOf(HasSubstr("more than 1 triangles"), HasSubstr("nodes[1]")));
  limits.triangles = 0;
  EXPECT_THAT(spoiled([](GltfBuilder&) {}, limits), HasSubstr("meshes[0].primitives[0]"));
}

TEST_F(LoadError, BrokenImages) {
  const auto image = [](const std::string& bytes) {
    return [=](GltfBuilder& b) {
      b.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(bytes)}}};
    };
  };
  const std::string header("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  expect(image(header.substr(0, 10)), "images[0]", "broken image header");
  expect(image(header + std::string("\0\0\0\1\0\0\0\1\x08\2\0\0\0\0\0\0\0", 17)), "images[0]",
         "cannot decode");
  // 65536 x 65536 pixels in 33 bytes
  expect(image(header + std::string("\0\1\0\0\0\1\0\0\x08\2\0\0\0\0\0\0\0", 17)), "images[0]",
         "65536x65536 pixels exceed the limit \"pixels\" of 268435456");
  LoadLimits limits;
  limits.texture_pixels = 100;
  EXPECT_THAT(
      spoiled(image(header + std::string("\0\0\0\x40\0\0\0\x40\x08\2\0\0\0\0\0\0\0", 17)), limits),
      AllOf(HasSubstr("images[0]: 64x64 pixels exceed"), HasSubstr("\"pixels\" of 100")));
  expect(
      [](GltfBuilder& b) {
        b.json["images"] = {{{"uri", "gone.png"}}};
      },
      "images[0]", "gone.png");
  expect([](GltfBuilder& b) { b.json["images"] = Json::array({Json::object()}); }, "images[0]",
         "neither uri nor bufferView");
}

}  // namespace
}  // namespace lte::scene
