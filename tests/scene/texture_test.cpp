#include "lte/scene/texture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "tests/scene/expect.h"

namespace lte::scene {
namespace {

constexpr auto kRepeat = Wrap::Repeat;
constexpr auto kMirror = Wrap::MirroredRepeat;
constexpr auto kClamp = Wrap::ClampToEdge;

/// A row of gray texels.
Texture row(const std::vector<uint8_t>& codes, bool srgb = false) {
  std::vector<uint8_t> texels;
  for (const uint8_t code : codes) texels.insert(texels.end(), 3, code);
  return Texture(static_cast<int>(codes.size()), 1, std::move(texels), srgb);
}

TEST(Texture, DecodesSrgbAtTexelCentres) {
  const Texture texture = row({0, 10, 128, 255}, true);
  const std::array<int, 4> codes{0, 10, 128, 255};
  for (size_t i = 0; i < 4; ++i) {
    const Rgb value =
        texture.sample({(static_cast<float>(i) + 0.5f) / 4, 0.5f}, kRepeat, kRepeat, 0);
    EXPECT_NEAR(value.x, test::decode_srgb(codes[i]), 1e-6) << "code " << codes[i];
  }
}

TEST(Texture, KeepsLinearCodes) {
  EXPECT_FLOAT_EQ(row({51}).sample({0.3f, 0.7f}, kClamp, kClamp, 0).y, 0.2f);
}

TEST(Texture, InterpolatesAfterDecoding) {
  // Half way between black and white is half the light, not the light of code 127.
  EXPECT_NEAR(row({0, 255}, true).sample({0.5f, 0.5f}, kClamp, kClamp, 0).x, 0.5, 1e-6);
}

TEST(Texture, AveragesACheckerboardToHalfTheLight) {
  std::vector<uint8_t> texels;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) texels.insert(texels.end(), 3, (x + y) % 2 == 0 ? 255 : 0);
  }
  const Texture texture(16, 16, std::move(texels), true);
  for (const float footprint : {2.0f, 3.0f, 16.0f, 1000.0f}) {
    const Rgb value = texture.sample({0.37f, 0.81f}, kRepeat, kRepeat, footprint);
    EXPECT_NEAR(value.x, 0.5, 2e-5) << "footprint " << footprint;
  }
}

TEST(Texture, CoarsestLevelIsTheMeanWhateverTheSize) {
  Rng rng(7);
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 1}, {5, 7}, {13, 4}, {31, 33}, {1, 9}}) {
    std::vector<uint8_t> texels(static_cast<size_t>(width * height) * 3);
    std::array<double, 3> mean{};
    for (size_t i = 0; i < texels.size(); ++i) {
      texels[i] = static_cast<uint8_t>(rng.below(256));
      mean[i % 3] += test::decode_srgb(texels[i]) / (width * height);
    }
    const Rgb value = Texture(width, height, std::move(texels), true)
                          .sample({0.2f, 0.6f}, kRepeat, kRepeat, 1e9f);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(value[c], mean[static_cast<size_t>(c)], 2e-5) << width << "x" << height;
  }
}

TEST(Texture, BlendsTwoLevels) {
  // Levels of {0, 255}: itself, and its mean 0.5. A footprint of sqrt(2) lies half way.
  const Texture texture = row({0, 255});
  EXPECT_NEAR(texture.sample({0.25f, 0.5f}, kClamp, kClamp, std::sqrt(2.0f)).x, 0.25, 1e-5);
  EXPECT_NEAR(texture.sample({0.75f, 0.5f}, kClamp, kClamp, std::sqrt(2.0f)).x, 0.75, 1e-5);
}

TEST(Texture, WrapsAsNamed) {
  const Texture texture = row({0, 51, 102, 255});
  const auto at = [&](float texel, Wrap wrap) {
    return texture.sample({texel / 4, 0.5f}, wrap, kClamp, 0).x;
  };
  EXPECT_NEAR(at(4.5f, kRepeat), 0.0, 1e-5);
  EXPECT_NEAR(at(-0.5f, kRepeat), 1.0, 1e-5);
  EXPECT_NEAR(at(0.0f, kRepeat), 0.5, 1e-5) << "between the last and the first texel";
  EXPECT_NEAR(at(4.5f, kMirror), 1.0, 1e-5);
  EXPECT_NEAR(at(5.5f, kMirror), 0.4, 1e-5);
  EXPECT_NEAR(at(-1.5f, kMirror), 0.2, 1e-5);
  EXPECT_NEAR(at(8.5f, kMirror), 0.0, 1e-5);
  EXPECT_NEAR(at(0.0f, kMirror), 0.0, 1e-5);
  EXPECT_NEAR(at(9.0f, kClamp), 1.0, 1e-5);
  EXPECT_NEAR(at(-3.0f, kClamp), 0.0, 1e-5);
}

TEST(Texture, WrapsEachAxisByItsOwnMode) {
  const std::vector<uint8_t> texels{0,  0,  0,  255, 255, 255,
                                    51, 51, 51, 102, 102, 102};  // 0 1 / 0.2 0.4
  const Texture texture(2, 2, texels, false);
  EXPECT_NEAR(texture.sample({1.25f, 1.75f}, kRepeat, kClamp, 0).x, 0.2, 1e-5);
  EXPECT_NEAR(texture.sample({1.25f, 1.75f}, kClamp, kMirror, 0).x, 1.0, 1e-5);
}

TEST(Texture, TopLeftIsTheOrigin) {
  const std::vector<uint8_t> texels{255, 0, 0, 0, 255, 0, 0, 0, 255, 51, 51, 51};
  const Texture texture(2, 2, texels, false);
  EXPECT_EQ(texture.sample({0.25f, 0.25f}, kClamp, kClamp, 0), (Rgb{1, 0, 0}));
  EXPECT_EQ(texture.sample({0.25f, 0.75f}, kClamp, kClamp, 0), (Rgb{0, 0, 1}));
}

TEST(Texture, StaysFiniteForAnyCoordinate) {
  const Texture texture = row({10, 200, 30});
  for (const float uv : {INFINITY, -INFINITY, std::nanf(""), 3e38f, -3e38f, -1e-30f, 1e20f}) {
    for (const Wrap wrap : {kRepeat, kMirror, kClamp}) {
      for (const float footprint : {0.0f, 2.5f, INFINITY, std::nanf("")}) {
        const Rgb value = texture.sample({uv, -uv}, wrap, wrap, footprint);
        EXPECT_TRUE(is_finite(value) && value.x >= 0 && value.x <= 1) << uv << ' ' << footprint;
      }
    }
  }
}

TEST(Texture, CountsItsBytes) {
  // 4x2 and its levels 2x1 and 1x1: 8 texels of 3 bytes, 3 texels of 6.
  EXPECT_EQ(Texture(4, 2, std::vector<uint8_t>(24), true).size_bytes(), 24u + 18u);
}

TEST(Texture, RefusesASizeThatDoesNotFit) {
  EXPECT_THROW(Texture(2, 2, std::vector<uint8_t>(11), true), Error);
  EXPECT_THROW(Texture(0, 2, {}, true), Error);
}

}  // namespace
}  // namespace lte::scene
