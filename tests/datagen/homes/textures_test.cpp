#include "datagen/homes/textures/textures.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lte::datagen::homes {
namespace {

constexpr int kSize = 96;

float decode(uint8_t code) {
  const float c = static_cast<float>(code) / 255;
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

struct Named {
  const char* name;
  TexturePtr texture;
};

/// Bases beyond the range of albedos on purpose: the range holds all the same.
std::vector<Named> tileable(uint64_t seed) {
  Rng rng(seed);
  const Rgb a{0.9f, 0.5f, 0.01f}, b{0.2f, 0.95f, 0.3f};
  std::vector<Named> all{{"wood", wood_grain(kSize, a, &rng)},
                         {"planks", wood_planks(kSize, a, 8, &rng)},
                         {"tiles", tiles(kSize, a, b, 4, 4, false, false, &rng)},
                         {"bonded tiles", tiles(kSize, a, b, 3, 6, true, true, &rng)},
                         {"marble", marble(kSize, a, b, &rng)},
                         {"plaster", plaster(kSize, a, &rng)},
                         {"weave", weave(kSize, a, b, 16, &rng)},
                         {"wallpaper", wallpaper(kSize, a, b, 3, &rng)}};
  for (int cloth = 0; cloth < kCloths; ++cloth)
    all.push_back({"cloth", printed_cloth(kSize, static_cast<Cloth>(cloth), a, b, 3, &rng)});
  return all;
}

/// Mean difference of two columns (or rows) of texels.
double difference(const scene::Texture& t, int first, int second, bool columns) {
  double sum = 0;
  for (int i = 0; i < kSize; ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const auto at = [&](int k) {
        const int x = columns ? k : i, y = columns ? i : k;
        return static_cast<int>(t.texels()[static_cast<size_t>(3 * (y * kSize + x) + channel)]);
      };
      sum += std::abs(at(first) - at(second));
    }
  }
  return sum / (3 * kSize);
}

TEST(HomeTextures, LeftMeetsRightAndTopMeetsBottom) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    for (const Named& item : tileable(seed)) {
      for (const bool columns : {true, false}) {
        double largest = 0;
        for (int i = 0; i + 1 < kSize; ++i)
          largest = std::max(largest, difference(*item.texture, i, i + 1, columns));
        EXPECT_LE(difference(*item.texture, kSize - 1, 0, columns), 1.15 * largest + 1)
            << item.name << (columns ? " left/right" : " top/bottom") << ", seed " << seed;
      }
    }
  }
}

TEST(HomeTextures, AlbedosAreThoseOfRealSurfaces) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    std::vector<Named> all = tileable(seed);
    Rng rng(seed);
    const Rgb a{1, 0, 0.5f}, b{0, 1, 1}, c{0.9f, 0.9f, 0};
    for (int i = 0; i < 4; ++i) {
      all.push_back({"rug", rug(kSize, a, b, c, &rng)});
      all.push_back({"painting", painting(kSize, &rng)});
    }
    all.push_back({"books", book_spines(kSize, 12, &rng)});
    for (const Named& item : all) {
      for (const uint8_t code : item.texture->texels()) {
        ASSERT_GE(decode(code), 0.03f) << item.name;
        ASSERT_LE(decode(code), 0.85f) << item.name;
      }
    }
  }
}

TEST(HomeTextures, SameSeedGivesTheSameTexels) {
  const auto a = tileable(4), b = tileable(4), c = tileable(5);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].texture->texels(), b[i].texture->texels()) << a[i].name;
    EXPECT_NE(a[i].texture->texels(), c[i].texture->texels()) << a[i].name;
  }
}

}  // namespace
}  // namespace lte::datagen::homes
