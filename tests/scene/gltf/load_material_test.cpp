// Materials, textures and light groups.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "lte/image/png.h"
#include "lte/scene/surface.h"
#include "tests/scene/expect.h"
#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A picture of 2x1 texels with the given 8-bit codes.
std::string png(const std::array<int, 6>& codes) {
  image::Image picture(2, 1, 3);
  for (size_t i = 0; i < 6; ++i) picture.pixels[i] = static_cast<float>(codes[i]) / 255.0f;
  const std::vector<unsigned char> bytes = image::encode_png(picture);
  return {bytes.begin(), bytes.end()};
}

std::string jpeg(int width, int height, uint8_t gray) {
  const std::vector<uint8_t> pixels(static_cast<size_t>(width * height) * 3, gray);
  std::string out;
  stbi_write_jpg_to_func(
      [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                                   static_cast<size_t>(size));
      },
      &out, width, height, 3, pixels.data(), 95);
  return out;
}

class LoadMaterial : public test::GltfTest {
 protected:
  /// A triangle with uv = xy and one material.
  void start(const Json& material) {
    Json primitive = builder_.triangle();
    primitive["attributes"]["TEXCOORD_0"] = builder_.floats({0, 0, 1, 0, 0, 1}, "VEC2");
    primitive["attributes"]["TEXCOORD_1"] =
        builder_.floats({0.25f, 0.5f, 0.25f, 0.5f, 0.25f, 0.5f}, "VEC2");
    primitive["material"] = 0;
    builder_.mesh(primitive);
    builder_.json["materials"] = {material};
  }

  Scene load() { return GltfTest::load(builder_); }

  void add_png(const std::array<int, 6>& codes) {
    builder_.json["images"].push_back(
        {{"uri", "data:image/png;base64," + test::base64(png(codes))}});
  }

  GltfBuilder builder_;
};

TEST_F(LoadMaterial, ReadsFactors) {
  start({{"name", "lamp"},
         {"doubleSided", true},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}}},
         {"emissiveFactor", {1, 0.5, 0.25}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  const Material material = load().materials[0];
  EXPECT_EQ(material.name, "lamp");
  EXPECT_TRUE(material.double_sided);
  EXPECT_EQ(material.base_color, (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(material.emission, (Rgb{20, 10, 5}));
}

TEST_F(LoadMaterial, StrengthWithoutFactorEmitsNothing) {
  start({{"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  const Scene scene = load();
  EXPECT_FALSE(scene.materials[0].emissive());
  EXPECT_EQ(scene.instances[0].light_group, kNone);
}

TEST_F(LoadMaterial, DecodesBaseColorFromSrgb) {
  start({{"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 1, 1, 1}}, {"baseColorTexture", {{"index", 0}}}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({100, 150, 200, 0, 0, 0});
  const Scene scene = load();
  const Surface surface =
      evaluate_surface(scene, 0, 0, 0.25f, 0.5f, 0);  // uv (0.25, 0.5): the first texel's centre
  EXPECT_NEAR(surface.albedo.x, 0.5 * test::decode_srgb(100), 1e-5);
  EXPECT_NEAR(surface.albedo.y, test::decode_srgb(150), 1e-5);
  EXPECT_NEAR(surface.albedo.z, test::decode_srgb(200), 1e-5);
}

TEST_F(LoadMaterial, PicturesInOtherFormatsAreNotedWhereTheyCount) {
  const Json texture = {{"index", 0}};
  builder_.json["images"] = {
      {{"uri", "data:image/ktx2;base64," + test::base64("\xabKTX 20\xbb\r\n\x1a\n")}}};
  builder_.json["textures"] = {{{"source", 0}}};
  start({{"normalTexture", texture}});
  EXPECT_THAT(load().ignored,
              ElementsAre("texture in KTX2, neither PNG nor JPEG nor WebP (1 image)"));

  builder_.json["materials"] = {{{"emissiveFactor", {1, 1, 1}},
                                 {"emissiveTexture", texture},
                                 {"pbrMetallicRoughness",
                                  {{"baseColorFactor", {0.5, 1, 1, 1}},
                                   {"baseColorTexture", texture},
                                   {"metallicRoughnessTexture", texture}}}}};
  const Scene scene = load();
  EXPECT_THAT(scene.ignored,
              ElementsAre("texture in KTX2, neither PNG nor JPEG nor WebP (2 images)"))
      << "as a color and as a number";
  const Material& material = scene.materials[0];
  EXPECT_FALSE(material.emissive());
  EXPECT_EQ(material.metallic, 0);
  EXPECT_EQ(material.base_color_texture.texture, kNone);
  EXPECT_EQ(material.base_color.x, 0.5f);
  EXPECT_EQ(scene.instances[0].light_group, kNone);
}

TEST_F(LoadMaterial, EmissiveTextureScalesTheStrength) {
  start({{"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({255, 0, 188, 0, 0, 0});
  const Surface surface =
      evaluate_surface(load(), 0, 0, 0.6f, 0.3f, 0);  // TEXCOORD_1 is the first texel everywhere
  EXPECT_NEAR(surface.emission.x, 8, 1e-5);
  EXPECT_NEAR(surface.emission.y, 0, 1e-5);
  EXPECT_NEAR(surface.emission.z, 8 * test::decode_srgb(188), 1e-4);
  EXPECT_EQ(surface.light_group, 0);
}

TEST_F(LoadMaterial, ReadsWrapModesAndTransform) {
  const Json transform{
      {"offset", {0.5, -1}}, {"rotation", 0.25}, {"scale", {2, 3}}, {"texCoord", 1}};
  start({{"pbrMetallicRoughness",
          {{"baseColorTexture",
            {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}});
  builder_.json["extensionsRequired"] = {"KHR_texture_transform"};
  builder_.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  builder_.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  add_png({1, 2, 3, 4, 5, 6});
  const TextureRef ref = load().materials[0].base_color_texture;
  EXPECT_EQ(ref.wrap_u, Wrap::ClampToEdge);
  EXPECT_EQ(ref.wrap_v, Wrap::MirroredRepeat);
  EXPECT_EQ(ref.uv_set, 1);
  EXPECT_EQ(ref.offset.x, 0.5f);
  EXPECT_EQ(ref.offset.y, -1.0f);
  EXPECT_EQ(ref.scale.x, 2.0f);
  EXPECT_EQ(ref.scale.y, 3.0f);
  EXPECT_EQ(ref.rotation, 0.25f);
}

TEST_F(LoadMaterial, DecodesAnImageOnceAndOnlyIfUsed) {
  start({{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}}},
           {"metallicFactor", 0},
           {"metallicRoughnessTexture", {{"index", 2}}}}},
         {"emissiveTexture", {{"index", 2}}}});  // without emissiveFactor it has no effect
  builder_.json["materials"].push_back(
      {{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 1}}}});
  builder_.json["samplers"] = {{{"wrapS", 33071}}};
  builder_.json["textures"] = {{{"source", 1}}, {{"source", 1}, {"sampler", 0}}, {{"source", 0}}};
  builder_.json["images"].push_back({{"uri", "absent.png"}});
  add_png({255, 255, 255, 255, 255, 255});
  const Scene scene = load();
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, 0);
  EXPECT_EQ(scene.materials[1].emission_texture.texture, 0);
  EXPECT_EQ(scene.materials[1].emission_texture.wrap_u, Wrap::ClampToEdge);
  EXPECT_EQ(scene.materials[0].emission_texture.texture, kNone);
}

TEST_F(LoadMaterial, ReadsNormalMapsAndWhatTheyBend) {
  add_png({128, 128, 255, 255, 0, 128});
  start({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
         {"normalTexture", {{"index", 0}, {"texCoord", 1}, {"scale", 0.5}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  Json& attributes = test::first_primitive(builder_)["attributes"];
  attributes["NORMAL"] = builder_.floats({0, 0, 1, 0, 0, 1, 0, 1, 0});
  attributes["TANGENT"] = builder_.floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1}, "VEC4");
  const Scene scene = load();
  EXPECT_THAT(scene.ignored, IsEmpty());
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.normal_texture.uv_set, 1);
  EXPECT_EQ(material.normal_scale, 0.5f);
  ASSERT_EQ(scene.textures.size(), 2u) << "one picture as colors and as it stands";
  EXPECT_NE(material.normal_texture.texture, material.base_color_texture.texture);
  EXPECT_FALSE(scene.textures[static_cast<size_t>(material.normal_texture.texture)]->srgb());
  EXPECT_THAT(scene.meshes[0].normals, ElementsAre(Vec3{0, 0, 1}, Vec3{0, 0, 1}, Vec3{0, 1, 0}));
  ASSERT_EQ(scene.meshes[0].tangents.size(), 3u);
  EXPECT_EQ(scene.meshes[0].tangents[1].direction, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.meshes[0].tangents[2].sign, -1);

  builder_.json["materials"][0].erase("normalTexture");
  EXPECT_THAT(load().meshes[0].normals, IsEmpty()) << "surfaces without a map are flat";
}

TEST_F(LoadMaterial, GoesWithoutADamagedNormalMap) {
  start({{"normalTexture", {{"index", 0}}},
         {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
  builder_.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  builder_.json["images"] = {{{"uri", "data:image/png;base64," + test::base64("\x89PNG, once")}}};
  add_png({1, 2, 3, 4, 5, 6});
  const Scene scene = load();
  EXPECT_THAT(scene.ignored, ElementsAre("damaged picture of a normal map (1 image)"));
  EXPECT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.materials[0].normal_texture.texture, kNone);
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, 0);
  builder_.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  EXPECT_THAT(error(builder_), ::testing::HasSubstr("images[0]")) << "it is needed now";
}

TEST_F(LoadMaterial, DecodesAPictureOnceThatIsListedTwice) {
  start({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
         {"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", {{"index", 1}}}});
  builder_.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  builder_.json["images"] = {{{"uri", "p.png"}}, {{"uri", "p.png"}}};
  test::write_text(dir_ / "p.png", png({51, 51, 51, 51, 51, 51}));
  const Scene scene = load();
  EXPECT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.materials[0].emission_texture.texture, 0);
}

TEST_F(LoadMaterial, ReadsJpegFromABufferViewAndPngFromAFile) {
  start({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder_.json["materials"].push_back(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
  builder_.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  const std::string bytes = jpeg(8, 8, 128);
  const int view = builder_.view(std::vector<char>(bytes.begin(), bytes.end()));
  builder_.json["images"] = {{{"bufferView", view}, {"mimeType", "image/jpeg"}},
                             {{"uri", "a%20b.png"}}};
  test::write_text(dir_ / "a b.png", png({51, 51, 51, 51, 51, 51}));
  const Scene scene = load();
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.textures[0]->width(), 8);
  EXPECT_NEAR(scene.textures[0]->texels()[0], 128, 2);
  EXPECT_EQ(scene.textures[1]->texels()[0], 51);
}

TEST_F(LoadMaterial, ReadsAGlbWithAnImageInside) {
  start({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  const std::string bytes = png({1, 2, 3, 4, 5, 6});
  builder_.json["images"] = {
      {{"bufferView", builder_.view(std::vector<char>(bytes.begin(), bytes.end()))}}};
  builder_.save_glb(dir_ / "scene.glb");
  EXPECT_THAT(load_scene(dir_ / "scene.glb").textures.at(0)->texels(),
              ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(LoadMaterial, EachTextureHasItsOwnUvSet) {
  // TEXCOORD_3 is the first texel everywhere and TEXCOORD_7 the second; the color takes the one
  // that KHR_texture_transform names in place of the reference's own.
  const Json transform{{"texCoord", 7}};
  start({{"pbrMetallicRoughness",
          {{"baseColorTexture",
            {{"index", 0},
             {"texCoord", 3},
             {"extensions", {{"KHR_texture_transform", transform}}}}}}},
         {"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", {{"index", 0}, {"texCoord", 3}}}});
  Json& attributes = builder_.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_3"] = builder_.floats({0.25f, 0.5f, 0.25f, 0.5f, 0.25f, 0.5f}, "VEC2");
  attributes["TEXCOORD_7"] = builder_.accessor(
      std::vector<uint8_t>{191, 128, 191, 128, 191, 128, 0, 0}, test::kUnsignedByte, "VEC2", true);
  builder_.json["accessors"].back()["count"] = 3;
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({255, 0, 0, 0, 0, 255});
  const Surface surface = evaluate_surface(load(), 0, 0, 0.3f, 0.3f, 0);
  EXPECT_NEAR(surface.emission.x, 1, 1e-3);
  EXPECT_NEAR(surface.emission.z, 0, 1e-3);
  EXPECT_NEAR(surface.albedo.x, 0, 5e-3);
  EXPECT_NEAR(surface.albedo.z, 1, 5e-3);
}

TEST_F(LoadMaterial, SpecularGlossinessGivesItsDiffuseColor) {
  start({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}},
         {"extensions",
          {{"KHR_materials_pbrSpecularGlossiness",
            {{"diffuseFactor", {0.5, 0.25, 1, 1}},
             {"diffuseTexture", {{"index", 0}, {"texCoord", 1}}}}}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({255, 0, 0, 0, 0, 255});
  const Scene scene = load();
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{0.5f, 0.25f, 1}));
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, 0);
  EXPECT_EQ(scene.materials[0].base_color_texture.uv_set, 1);
  EXPECT_THAT(scene.ignored,
              ElementsAre("KHR_materials_pbrSpecularGlossiness: dropped specular and glossiness "
                          "(the diffuse color is kept) (1 material)"));
}

/// glTF 2.0, 5.22.4 and 5.22.5: both are 1 where a file says nothing.
TEST_F(LoadMaterial, MetalFollowsTheSpecification) {
  start(Json::object());
  builder_.json["materials"].push_back(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}}});
  builder_.json["materials"].push_back(
      {{"pbrMetallicRoughness", {{"metallicFactor", 7}, {"roughnessFactor", -1}}}});
  builder_.json["materials"].push_back({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  builder_.json["materials"].push_back(
      {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", Json::object()}}}});
  builder_.mesh(builder_.triangle());  // has no material at all
  const Scene scene = load();
  ASSERT_EQ(scene.materials.size(), 6u);
  const auto expect = [&](size_t i, float metallic, float roughness) {
    EXPECT_EQ(scene.materials[i].metallic, metallic) << i;
    EXPECT_EQ(scene.materials[i].roughness, roughness) << i;
  };
  expect(0, 1, 1);
  expect(1, 0.25f, 0.5f);
  expect(2, 1, 0);
  expect(3, 0, 1);
  expect(4, 0, 1);
  expect(5, 1, 1);
}

TEST_F(LoadMaterial, MetalTextureIsLinear) {
  start({{"pbrMetallicRoughness",
          {{"metallicFactor", 0.5},
           {"baseColorTexture", {{"index", 0}}},
           {"metallicRoughnessTexture", {{"index", 0}}}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({200, 51, 102, 0, 255, 0});
  const Scene scene = load();
  ASSERT_EQ(scene.textures.size(), 2u) << "colors on the sRGB curve, and the rest";
  EXPECT_THAT(scene.ignored, ::testing::IsEmpty());
  const Surface surface =
      evaluate_surface(scene, 0, 0, 0.25f, 0.5f, 0);  // the first texel's centre
  EXPECT_NEAR(surface.gloss.roughness, 51 / 255.0, 1e-5);
  EXPECT_NEAR(surface.gloss.metallic, 0.5 * 102 / 255.0, 1e-5);
  EXPECT_NEAR(surface.albedo.y, test::decode_srgb(51), 1e-5);
}

TEST_F(LoadMaterial, NotesTexturesItCannotFollow) {
  start({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
         {"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", {{"index", 1}, {"texCoord", 8}}}});
  builder_.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}},
                               {{"source", 0}}};
  add_png({1, 2, 3, 4, 5, 6});
  const Scene scene = load();
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_THAT(scene.ignored, ElementsAre("texture coordinates beyond TEXCOORD_7 (1 use)",
                                         "texture without a PNG, JPEG or WebP source (1 use)"));
}

TEST_F(LoadMaterial, NumbersLightGroupsByInstanceThenLight) {
  start({{"emissiveFactor", {1, 1, 1}}});
  builder_.json["materials"].push_back(Json::object());
  Json dark = builder_.triangle();
  dark["material"] = 1;
  builder_.json["meshes"].push_back({{"primitives", {dark}}});
  builder_.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"name", "bulb"}}};
  builder_.json["nodes"] = {{{"name", "table"}, {"mesh", 1}},
                            {{"name", "left lamp"}, {"mesh", 0}},
                            {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                            {{"name", "right lamp"}, {"mesh", 0}}};
  const Scene scene = load();
  EXPECT_THAT(scene.light_groups, ElementsAre("left lamp", "right lamp", "bulb"));
  EXPECT_EQ(scene.instances[0].light_group, kNone);
  EXPECT_EQ(scene.instances[1].light_group, 0);
  EXPECT_EQ(scene.instances[2].light_group, 1);
  EXPECT_EQ(scene.lights.at(0).light_group, 2);
}

TEST_F(LoadMaterial, BlackEmissiveTextureIsStillALuminaire) {
  start({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  builder_.json["textures"] = {{{"source", 0}}};
  add_png({0, 0, 0, 0, 0, 0});
  const Scene scene = load();
  EXPECT_EQ(scene.light_groups.size(), 1u);
  EXPECT_EQ(evaluate_surface(scene, 0, 0, 0.3f, 0.3f, 0).emission, (Rgb{0, 0, 0}));
}

}  // namespace
}  // namespace lte::scene
