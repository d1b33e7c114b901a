// Checksums against the values their standards give, and PNG files chunk by chunk.
#include "lte/base/png.h"

#include <string>

#include <gtest/gtest.h>

#include "lte/base/check.h"

namespace lte {
namespace {

std::vector<unsigned char> bytes(const std::string& text) { return {text.begin(), text.end()}; }

TEST(Crc, IsTheCheckValueOfItsStandard) {
  EXPECT_EQ(crc32(bytes("123456789")), 0xCBF43926U);   // ISO 3309
  EXPECT_EQ(crc32(bytes("IEND")), 0xAE426082U);        // the last bytes of every PNG file
  EXPECT_EQ(crc32c(bytes("123456789")), 0xE3069283U);  // RFC 3720, B.4 and its usual check
  EXPECT_EQ(crc32c(std::vector<unsigned char>(32, 0)), 0x8A9136AAU);
  EXPECT_EQ(crc32c(std::vector<unsigned char>(32, 0xFF)), 0x62A8AB43U);
}

TEST(StoredPng, IsTheBytesOfTheSpecification) {
  const std::vector<unsigned char> red = {255, 0, 0};
  const std::vector<unsigned char> png = encode_stored_png(1, 1, red);
  // One row: filter 0, 255, 0, 0. Adler-32: a = 1 + 255 = 256, b = 1 + 256 + 256 + 256 = 769.
  const std::vector<unsigned char> stream = {0x78, 0x01, 1, 4,    0,    0xFB, 0xFF, 0,
                                             255,  0,    0, 0x03, 0x01, 0x01, 0x00};
  ASSERT_EQ(png.size(), 8 + 25 + 12 + stream.size() + 12);
  EXPECT_EQ(std::string(png.begin() + 12, png.begin() + 16), "IHDR");
  EXPECT_EQ(std::vector<unsigned char>(png.begin() + 16, png.begin() + 29),
            (std::vector<unsigned char>{0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0}));
  EXPECT_EQ(png[36], stream.size());
  EXPECT_EQ(std::vector<unsigned char>(png.begin() + 41, png.begin() + 41 + 15), stream);
}

TEST(StoredPng, CutsLongPicturesIntoBlocks) {
  const std::vector<unsigned char> rgb(size_t{3} * 200 * 150, 7);
  const size_t data = 150 * (1 + 600);  // two blocks
  EXPECT_EQ(encode_stored_png(200, 150, rgb).size(), 8 + 25 + 12 + 2 + 2 * 5 + data + 4 + 12);
}

TEST(StoredPng, RefusesAnotherSize) {
  EXPECT_THROW(encode_stored_png(2, 2, std::vector<unsigned char>(11)), Error);
  EXPECT_THROW(encode_stored_png(0, 2, {}), Error);
}

}  // namespace
}  // namespace lte
