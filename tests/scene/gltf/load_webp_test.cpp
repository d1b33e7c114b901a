// EXT_texture_webp: pictures encoded by libwebp's own encoder must come back.
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <webp/encode.h>

#include "tests/scene/gltf/fixture.h"

namespace lte::scene {
namespace {

using test::GltfBuilder;
using test::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<uint8_t> picture(int width, int height) {
  std::vector<uint8_t> rgb;
  for (int i = 0; i < width * height; ++i) {
    for (const int v : {i * 7, 255 - i * 3, i * i}) rgb.push_back(static_cast<uint8_t>(v & 255));
  }
  return rgb;
}

std::vector<uint8_t> webp(const std::vector<uint8_t>& rgb, int width, int height, bool lossless) {
  uint8_t* bytes = nullptr;
  const size_t size = lossless ? WebPEncodeLosslessRGB(rgb.data(), width, height, width * 3, &bytes)
                               : WebPEncodeRGB(rgb.data(), width, height, width * 3, 90, &bytes);
  std::vector<uint8_t> out(bytes, bytes + size);
  WebPFree(bytes);
  return out;
}

class LoadWebp : public test::GltfTest {
 protected:
  GltfBuilder textured(const std::vector<uint8_t>& bytes) {
    GltfBuilder builder;
    Json primitive = builder.triangle();
    primitive["attributes"]["TEXCOORD_0"] = builder.floats({0, 0, 1, 0, 0, 1}, "VEC2");
    primitive["material"] = 0;
    builder.mesh(primitive);
    builder.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.json["extensionsRequired"] = {"EXT_texture_webp"};
    builder.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    builder.json["images"] = {{{"bufferView", builder.view(bytes)}, {"mimeType", "image/webp"}}};
    return builder;
  }

  std::string error_with(const std::vector<uint8_t>& bytes, const LoadLimits& limits = {}) {
    GltfBuilder builder = textured(bytes);
    return error(builder, limits);
  }
};

TEST_F(LoadWebp, LosslessComesBackBitForBit) {
  GltfBuilder builder = textured(webp(picture(13, 9), 13, 9, true));
  const Scene scene = load(builder);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0]->width(), 13);
  EXPECT_EQ(scene.textures[0]->height(), 9);
  EXPECT_EQ(scene.textures[0]->texels(), picture(13, 9));
  EXPECT_TRUE(scene.textures[0]->srgb());
  EXPECT_THAT(scene.ignored, ::testing::IsEmpty());
}

TEST_F(LoadWebp, LossyComesBackNearly) {
  const std::vector<uint8_t> gray(32 * 32 * 3, 100);
  GltfBuilder builder = textured(webp(gray, 32, 32, false));
  const Scene scene = load(builder);
  for (const uint8_t texel : scene.textures.at(0)->texels()) EXPECT_NEAR(texel, 100, 3);
}

TEST_F(LoadWebp, ComesBeforeTheFallbackPicture) {
  GltfBuilder builder = textured(webp(picture(5, 4), 5, 4, true));
  builder.json["textures"][0]["source"] = 1;
  builder.json["images"].push_back({{"uri", "absent.png"}});
  EXPECT_EQ(load(builder).textures.at(0)->width(), 5);
}

TEST_F(LoadWebp, EveryTruncationIsAnError) {
  for (const bool lossless : {true, false}) {
    const std::vector<uint8_t> whole = webp(picture(40, 30), 40, 30, lossless);
    for (size_t size = 12; size < whole.size(); size += 97) {
      const std::vector<uint8_t> cut(whole.begin(),
                                     whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_THAT(error_with(cut), HasSubstr("scene.gltf: images[0]")) << size;
    }
  }
}

TEST_F(LoadWebp, BombsAreRefusedByTheirHeader) {
  // A lossless picture of 16383 x 16383 in one color takes a few hundred bytes.
  const std::vector<uint8_t> small = webp(picture(8, 8), 8, 8, true);
  std::vector<uint8_t> bomb = small;
  // RIFF (12), "VP8L" and size (8), signature (1), then 14 bits of width - 1 and of height - 1.
  const uint32_t sizes = 16382u | 16382u << 14 | (uint32_t{small[24]} & 0xf0u) << 24;
  std::memcpy(bomb.data() + 21, &sizes, 4);
  LoadLimits limits;
  limits.texture_pixels = 1 << 24;
  EXPECT_THAT(error_with(bomb, limits), AllOf(HasSubstr("images[0]"), HasSubstr("16383x16383")));
}

TEST_F(LoadWebp, AllPicturesTogetherHaveALimit) {
  GltfBuilder builder = textured(webp(picture(8, 8), 8, 8, true));
  builder.json["images"].push_back(
      {{"bufferView", builder.view(webp(picture(8, 8), 8, 8, false))}});
  builder.json["textures"].push_back({{"source", 1}});
  builder.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
  builder.json["materials"][0]["emissiveTexture"] = {{"index", 1}};
  LoadLimits limits;
  // Two of 64 pixels: 3 bytes of color each, and 6 for each pixel of mip levels, a third as many.
  limits.picture_bytes = 639;
  EXPECT_THAT(test::error_of([&] { load(builder, limits); }),
              AllOf(HasSubstr("images[1]: 8x8 pixels"), HasSubstr("640 bytes"),
                    HasSubstr("the limit \"pictures\" is 639 bytes")));
  limits.picture_bytes = 640;
  EXPECT_EQ(load(builder, limits).textures.size(), 2u);
}

TEST_F(LoadWebp, IndicesPastTheEnd) {
  GltfBuilder builder = textured(webp(picture(8, 8), 8, 8, true));
  builder.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 3;
  EXPECT_THAT(test::error_of([&] { load(builder); }),
              AllOf(HasSubstr("textures[0].extensions.EXT_texture_webp.source is 3"),
                    HasSubstr("1 images")));
}

}  // namespace
}  // namespace lte::scene
