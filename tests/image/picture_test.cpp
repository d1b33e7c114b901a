// Picture files of every format, written byte by byte where no writer of ours exists.
#include "lte/image/picture.h"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using ::testing::HasSubstr;

class PictureFile : public ::testing::Test {
 protected:
  Picture read(const std::string& name, const std::string& content) {
    write_file(dir_ / name, content);
    return read_picture(dir_ / name);
  }
  std::string error(const std::string& name, const std::string& content) {
    return test::error_of([&] { read(name, content); });
  }
  test::TempDir dir_;
};

std::string floats(const std::vector<float>& values, bool big) {
  std::string out;
  for (const float value : values) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    if (big) {
      std::swap(bytes[0], bytes[3]);
      std::swap(bytes[1], bytes[2]);
    }
    out.append(bytes, 4);
  }
  return out;
}

TEST_F(PictureFile, PfmOfBothByteOrdersRunsFromTheBottomUp) {
  const std::vector<float> values{1, 2, 3, 4, 5, 6};  // bottom row, top row
  for (const bool big : {false, true}) {
    const Picture picture =
        read("a.pfm", std::string("PF\n1 2\n") + (big ? "1.0\n" : "-1.0\n") + floats(values, big));
    EXPECT_FALSE(picture.coded);
    EXPECT_EQ(picture.image.rgb(0, 0), (Rgb{4, 5, 6}));
    EXPECT_EQ(picture.image.rgb(0, 1), (Rgb{1, 2, 3}));
    const Picture gray =
        read("g.pfm", std::string("Pf\n2 1\n") + (big ? "1\n" : "-1\n") + floats({0.5f, -7}, big));
    EXPECT_EQ(gray.image.channels, 1);
    EXPECT_EQ(gray.image.pixels[1], -7);
  }
}

TEST_F(PictureFile, TgaIsCoded) {
  std::string tga(18, '\0');
  tga[2] = 2;  // true color, not compressed
  tga[12] = 2;
  tga[14] = 1;  // 2 x 1
  tga[16] = 24;
  tga[17] = 0x20;
  tga += std::string("\x00\x33\xff", 3) + std::string("\xff\x00\x00", 3);  // BGR
  const Picture picture = read("a.TGA", tga);
  EXPECT_TRUE(picture.coded);
  EXPECT_EQ(picture.image.rgb(0, 0), (Rgb{1, 51 / 255.f, 0}));
  EXPECT_EQ(picture.image.rgb(1, 0), (Rgb{0, 0, 1}));
}

TEST_F(PictureFile, RadianceHdrIsLinear) {
  // RGBE: mantissa / 256 * 2^(exponent - 128); 128 with exponent 130 is 2.
  const Picture picture = read("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" +
                                            std::string("\x80\x40\x20\x82", 4));
  EXPECT_FALSE(picture.coded);
  EXPECT_EQ(picture.image.rgb(0, 0), (Rgb{2, 1, 0.5f}));
}

TEST_F(PictureFile, PngAndExrAreToldApartByContent) {
  Image image(1, 1, 3);
  image.set_rgb(0, 0, {1, 0.2f, 0});
  write_png(dir_ / "a.jpg", image);
  EXPECT_TRUE(read_picture(dir_ / "a.jpg").coded);
  EXPECT_NEAR(read_picture(dir_ / "a.jpg").image.rgb(0, 0).y, 0.2f, 1e-6);
  write_exr(dir_ / "a.dat", {{"", &image}});
  EXPECT_FALSE(read_picture(dir_ / "a.dat").coded);
  EXPECT_EQ(read_picture(dir_ / "a.dat").image.rgb(0, 0), (Rgb{1, 0.2f, 0}));
}

TEST_F(PictureFile, BrokenFiles) {
  EXPECT_THAT(error("a.bin", "a poem"), HasSubstr("a.bin: none of PNG"));
  EXPECT_THAT(error("a.pfm", "PF\n4 4\n-1\nxxxx"), HasSubstr("a.pfm: truncated PFM"));
  EXPECT_THAT(error("a.pfm", "PF\n4"), HasSubstr("broken PFM header"));
  EXPECT_THAT(error("a.pfm", "PF\nfour 4\n-1\n"), HasSubstr("\"four\" is no number"));
  EXPECT_THAT(error("a.pfm", "PF\n-4 4\n-1\n"), HasSubstr("empty picture"));
  EXPECT_THAT(error("a.pfm", "PF\n1000000 1000000\n-1\n"), HasSubstr("exceed the limit"));
  EXPECT_THAT(error("a.hdr", "#?RADIANCE\n"), HasSubstr("a.hdr"));
  EXPECT_THAT(error("a.tga", "tga"), HasSubstr("a.tga: broken picture header"));
  EXPECT_THAT(error("a.png", "\x89PNG"), HasSubstr("a.png"));
  EXPECT_THAT(test::error_of([&] { read_picture(dir_ / "none"); }), HasSubstr("none"));
}

}  // namespace
}  // namespace lte::image
