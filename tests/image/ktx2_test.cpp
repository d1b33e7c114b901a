#include "lte/image/ktx2.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "lte/base/half.h"
#include "lte/base/random.h"
#include "tests/image/ktx2_reader.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::from_rgb9e5;
using test::read_ktx2;
using test::TempDir;
using testing::HasSubstr;

Rgb random_color(Rng& rng, float low, float high) {
  const auto channel = [&] { return std::exp2(rng.uniform(low, high)); };
  const float x = channel(), y = channel();
  return {x, y, channel()};
}

/// A texture of values that the format holds exactly or not, from dark to bright.
Ktx2 random_texture(Ktx2Format format, int width, int height, int depth, int layers) {
  Ktx2 texture{format, width, height, depth, layers, {}};
  Rng rng(7);
  const int slices = std::max({depth, layers, 1});
  for (int i = 0; i < width * height * slices; ++i)
    texture.texels.push_back(random_color(rng, -20, 15.9f));
  return texture;
}

/// The formula of EXT_texture_shared_exponent, in double.
uint32_t rgb9e5_of_the_specification(const Rgb& color) {
  const double limit = 511.0 / 512 * 65536;
  double c[3], largest = 0;
  for (int i = 0; i < 3; ++i) {
    c[i] = std::max(0.0, std::min(limit, static_cast<double>(color[i])));
    largest = std::max(largest, c[i]);
  }
  const double preliminary = std::max(-16.0, std::floor(std::log2(largest))) + 16;
  const double max_s = std::floor(largest / std::exp2(preliminary - 24) + 0.5);
  const double exponent = max_s == 512 ? preliminary + 1 : preliminary;
  uint32_t word = static_cast<uint32_t>(exponent) << 27;
  for (int i = 0; i < 3; ++i)
    word |= static_cast<uint32_t>(std::floor(c[i] / std::exp2(exponent - 24) + 0.5)) << (9 * i);
  return word;
}

float as_half(float value) { return to_float(to_half(std::min(value, kMaxHalf))); }

/// What a file of the texture holds.
Rgb stored(const Rgb& color, Ktx2Format format) {
  if (format == Ktx2Format::Rgb9e5) return from_rgb9e5(rgb9e5_of_the_specification(color));
  return {as_half(color.x), as_half(color.y), as_half(color.z)};
}

TEST(Rgb9e5, RoundsAsTheSpecificationSays) {
  Rng rng(3);
  for (int i = 0; i < 100'000; ++i) {
    const Rgb color = random_color(rng, -30, 20);
    ASSERT_EQ(to_rgb9e5(color), rgb9e5_of_the_specification(color))
        << color.x << ' ' << color.y << ' ' << color.z;
  }
  EXPECT_EQ(to_rgb9e5({0, 0, 0}), 0u);
  EXPECT_EQ(to_rgb9e5({-1, 0, -0.0f}), 0u);
  EXPECT_EQ(to_rgb9e5({1, 1, 1}), 16u << 27 | 256u << 18 | 256u << 9 | 256u);
  // A mantissa that rounds up to 512 raises the exponent.
  EXPECT_EQ(to_rgb9e5({1.9999f, 0, 0}), 17u << 27 | 256u);
  EXPECT_EQ(to_rgb9e5({1e9f, 0, 0}), 31u << 27 | 511u);
  EXPECT_EQ(from_rgb9e5(31u << 27 | 511u).x, 65408);
}

TEST(Rgb9e5, EveryWordThatTheFormulaGivesIsRead) {
  for (uint32_t exponent = 1; exponent < 32; ++exponent) {
    for (uint32_t mantissa = 256; mantissa < 512; ++mantissa) {
      const uint32_t word = exponent << 27 | 7u << 18 | 3u << 9 | mantissa;
      ASSERT_EQ(to_rgb9e5(from_rgb9e5(word)), word);
    }
  }
}

TEST(Ktx2Files, EveryTexelComesBack) {
  const TempDir folder;
  for (const Ktx2Format format : {Ktx2Format::Rgb9e5, Ktx2Format::Rgba16f}) {
    for (const auto& [width, height, depth, layers] :
         {std::array{1, 1, 0, 0}, {5, 3, 0, 0}, {4, 3, 0, 2}, {3, 4, 6, 0}, {2, 2, 0, 1}}) {
      const Ktx2 out = random_texture(format, width, height, depth, layers);
      write_ktx2(folder / "t.ktx2", out);
      const Ktx2 in = read_ktx2(folder / "t.ktx2");
      EXPECT_EQ(in.format, format);
      EXPECT_EQ(in.width, width);
      EXPECT_EQ(in.height, height);
      EXPECT_EQ(in.depth, depth);
      EXPECT_EQ(in.layers, layers);
      ASSERT_EQ(in.texels.size(), out.texels.size());
      for (size_t i = 0; i < in.texels.size(); ++i)
        EXPECT_EQ(in.texels[i], stored(out.texels[i], format));
    }
  }
}

TEST(Ktx2Files, HalvesKeepTheirSignAndSaturate) {
  const TempDir folder;
  write_ktx2(folder / "t.ktx2", {Ktx2Format::Rgba16f, 1, 1, 0, 0, {{-0.5f, 1e6f, -1e6f}}});
  EXPECT_EQ(read_ktx2(folder / "t.ktx2").texels[0], (Rgb{-0.5f, kMaxHalf, -kMaxHalf}));
}

// Fields at their places, as the KTX 2.0 specification lists them.
TEST(Ktx2Files, HeaderAndDescriptorAreThoseOfTheSpecification) {
  const TempDir folder;
  write_ktx2(folder / "t.ktx2", random_texture(Ktx2Format::Rgb9e5, 5, 3, 2, 0));
  const std::string bytes = read_file(folder / "t.ktx2");
  const auto word = [&](size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
  const std::vector<uint32_t> fields{123, 4, 5, 3, 2, 0, 1, 1, 0, 104, 4 + 24 + 6 * 16};
  for (size_t i = 0; i < fields.size(); ++i) EXPECT_EQ(word(12 + 4 * i), fields[i]) << i;
  EXPECT_EQ(word(56), word(48) + word(52)) << "keys follow the descriptor";
  EXPECT_EQ(word(80) % 8, 0u);
  EXPECT_EQ(word(88), 5u * 3 * 2 * 4);
  EXPECT_EQ(word(96), word(88));
  EXPECT_EQ(bytes.size(), word(80) + word(88));
  // The descriptor: RGBSDA, BT.709, linear; 1 × 1 texels of 4 bytes; first sample red's mantissa,
  // second its exponent, which is 2^5 wide from bit 27 on.
  EXPECT_EQ(word(104), word(52));
  EXPECT_EQ(word(112), 2u | (24u + 6 * 16) << 16);
  EXPECT_EQ(word(116), 0x00010101u);
  EXPECT_EQ(word(120), 0u);
  EXPECT_EQ(word(124), 4u);
  EXPECT_EQ(word(132), 0u | 8u << 16 | 0u << 24);
  EXPECT_EQ(word(144), 8448u);
  EXPECT_EQ(word(148), 27u | 4u << 16 | 0x20u << 24);
  EXPECT_EQ(word(156), 15u);
  EXPECT_EQ(word(160), 31u);
}

TEST(Ktx2Files, RefusesToWriteNonsense) {
  const TempDir folder;
  const auto refusal = [&](const Ktx2& texture) {
    return error_of([&] { write_ktx2(folder / "t.ktx2", texture); });
  };
  Ktx2 texture = random_texture(Ktx2Format::Rgb9e5, 2, 2, 0, 0);
  texture.texels[1].y = NAN;
  EXPECT_THAT(refusal(texture), HasSubstr("t.ktx2: texel 1 is not finite"));
  texture.texels.pop_back();
  EXPECT_THAT(refusal(texture), HasSubstr("expected 4 texels, got 3"));
  texture.depth = texture.layers = 2;
  EXPECT_THAT(refusal(texture), HasSubstr("not a texture"));
  EXPECT_EQ(folder.count(), 0u);
}

TEST(Ktx2Files, PyKtx2ReadsThemAlike) {
  // scripts/setup.sh --tests installs it into the first.
  std::string python;
  for (const std::string candidate : {LTE_SOURCE_DIR "/.venv/tests/bin/python", "python3"}) {
    if (python.empty() && std::system((candidate + " -c 'import pyktx2' 2>/dev/null").c_str()) == 0)
      python = candidate;
  }
  if (python.empty()) GTEST_SKIP() << "no Python with pyktx2";
  const TempDir folder;
  int number = 0;
  for (const Ktx2Format format : {Ktx2Format::Rgb9e5, Ktx2Format::Rgba16f}) {
    for (const auto& [width, height, depth, layers] :
         {std::array{5, 3, 0, 0}, {4, 3, 0, 2}, {3, 4, 6, 0}}) {
      const std::string name = "t" + std::to_string(number++);
      const Ktx2 texture = random_texture(format, width, height, depth, layers);
      write_ktx2(folder / (name + ".ktx2"), texture);
      std::ofstream expected(folder / (name + ".txt"));
      expected << (format == Ktx2Format::Rgb9e5 ? 123 : 97) << ' ' << width << ' ' << height << ' '
               << depth << ' ' << layers << '\n';
      expected.precision(9);
      for (const Rgb& color : texture.texels) {
        const Rgb value = stored(color, format);
        expected << value.x << ' ' << value.y << ' ' << value.z << '\n';
      }
    }
  }
  EXPECT_EQ(std::system(
                (python + " " LTE_SOURCE_DIR "/tests/image/check_ktx2.py " + folder.path().string())
                    .c_str()),
            0);
}

}  // namespace
}  // namespace lte::image
