#include "lte/image/png.h"

#include <cmath>

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "tests/image/random_image.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

/// A chunk of a PNG. The decoder checks no CRC; zero stands for it.
std::string chunk(const std::string& type, const std::string& data) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(data.size() >> shift);
  return out + type + data + std::string(4, '\0');
}

std::string be32(uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift);
  return out;
}

/// A PNG whose pixel rows (each with its filter byte) are stored without compression.
std::string stored_png(uint32_t width, uint32_t height, int bits, int color_type,
                       const std::string& rows) {
  const std::string header = be32(width) + be32(height) + static_cast<char>(bits) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  const auto size = static_cast<uint16_t>(rows.size());
  std::string zlib = "\x78\x01\x01";
  for (const uint16_t value : {size, static_cast<uint16_t>(~size)}) {
    zlib += static_cast<char>(value & 255);
    zlib += static_cast<char>(value >> 8);
  }
  zlib += rows + std::string(4, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", zlib) + chunk("IEND", "");
}

TEST(Png, RoundTripsToEightBits) {
  const TempDir dir;
  const Image picture = test::random_image(37, 21, 3, 1);
  write_png(dir / "a.png", picture);
  const Image again = read_png(dir / "a.png");
  ASSERT_EQ(again.width, 37);
  ASSERT_EQ(again.height, 21);
  ASSERT_EQ(again.channels, 3);
  for (size_t i = 0; i < picture.pixels.size(); ++i)
    EXPECT_NEAR(again.pixels[i], picture.pixels[i], 0.5 / 255 + 1e-6);
  EXPECT_EQ(dir.count(), 1u);
}

TEST(Png, RoundsAndClamps) {
  const TempDir dir;
  Image picture(7, 1, 1);
  picture.pixels = {-1, 2, NAN, INFINITY, 100.4f / 255, 100.6f / 255, 0};
  write_png(dir / "a.png", picture);
  const Image again = read_png(dir / "a.png");
  const std::vector<int> expected = {0, 255, 0, 255, 100, 101, 0};
  for (int x = 0; x < 7; ++x) {
    const Rgb rgb = again.rgb(x, 0);
    EXPECT_EQ(std::lround(255 * rgb.x), expected[static_cast<size_t>(x)]);
    EXPECT_EQ(rgb, (Rgb{rgb.x, rgb.x, rgb.x})) << "grey is read as three equal channels";
  }
}

TEST(Png, EncodesTheBytesOfTheFile) {
  const TempDir dir;
  const Image picture = test::random_image(16, 9, 3, 1);
  write_png(dir / "a.png", picture);
  const std::vector<unsigned char> bytes = encode_png(picture);
  EXPECT_EQ(read_file(dir / "a.png"), std::string(bytes.begin(), bytes.end()));
}

TEST(Png, ReadsSixteenBitsAndAlpha) {
  const TempDir dir;
  write_file(dir / "rgb16.png",
             stored_png(1, 1, 16, 2, std::string("\0\x12\x34\x80\x00\xff\xff", 7)));
  const Image deep = read_png(dir / "rgb16.png");
  ASSERT_EQ(deep.channels, 3);
  EXPECT_FLOAT_EQ(deep.pixels[0], 0x1234 / 65535.0f);
  EXPECT_FLOAT_EQ(deep.pixels[1], 0x8000 / 65535.0f);
  EXPECT_EQ(deep.pixels[2], 1);
  write_file(dir / "rgba.png",
             stored_png(2, 1, 8, 6, std::string("\0\x33\x66\x99\xcc\xff\x00\xff\x00", 9)));
  const Image alpha = read_png(dir / "rgba.png");
  ASSERT_EQ(alpha.channels, 4);
  EXPECT_FLOAT_EQ(alpha.at(0, 0)[3], 0.8f);
  EXPECT_EQ(alpha.at(1, 0)[3], 0);
  EXPECT_EQ(alpha.at(1, 0)[2], 1);
}

TEST(Png, RefusesAnImageBombBeforeDecoding) {
  const TempDir dir;
  write_file(dir / "bomb.png", stored_png(17000, 17000, 8, 2, "x"));
  EXPECT_THAT(error_of([&] { read_png(dir / "bomb.png"); }),
              AllOf(HasSubstr("bomb.png"), HasSubstr("17000 x 17000 pixels exceed the limit")));
  write_file(dir / "bomb.png", stored_png(2'000'000'000, 2'000'000'000, 8, 2, "x"));
  EXPECT_THAT(error_of([&] { read_png(dir / "bomb.png"); }),
              HasSubstr("2000000000 x 2000000000 pixels exceed the limit"));
  write_png(dir / "a.png", Image(10, 10, 3));
  EXPECT_EQ(read_png(dir / "a.png", 100).width, 10);
  EXPECT_THAT(error_of([&] { read_png(dir / "a.png", 99); }),
              HasSubstr("10 x 10 pixels exceed the limit of 99"));
}

TEST(Png, RefusesWhatItCannotDecode) {
  const TempDir dir;
  write_file(dir / "text.png", "this is no picture");
  write_file(dir / "empty.png", "");
  for (const char* name : {"text.png", "empty.png"}) {
    EXPECT_THAT(error_of([&] { read_png(dir / name); }),
                AllOf(HasSubstr(name), HasSubstr("neither PNG nor JPEG")));
  }
  EXPECT_THAT(error_of([&] { read_png(dir / "none.png"); }),
              AllOf(HasSubstr("none.png"), HasSubstr("No such file")));
}

TEST(Png, EveryTruncationIsRefusedOrWhole) {
  const TempDir dir;
  const std::vector<unsigned char> png = encode_png(test::random_image(8, 8, 3, 1));
  const std::string bytes(png.begin(), png.end());
  // The last 12 bytes (IEND) carry no pixel.
  for (size_t size = 0; size + 12 < bytes.size(); size += 3) {
    test::write_text(dir / "cut.png", bytes.substr(0, size));
    EXPECT_THAT(error_of([&] { read_png(dir / "cut.png"); }), HasSubstr("cannot decode")) << size;
  }
}

TEST(Png, RefusesWhatItCannotWrite) {
  const TempDir dir;
  EXPECT_THAT(error_of([&] { write_png(dir / "a.png", Image(2, 2, 4)); }),
              HasSubstr("1 or 3 channels, got 4"));
  EXPECT_THAT(error_of([&] { write_png(dir / "no/a.png", Image(2, 2, 3)); }),
              HasSubstr("no/a.png"));
}

}  // namespace
}  // namespace lte::image
