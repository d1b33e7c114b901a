// The checksum against the values that its standard gives.
#include "lte/base/crc32c.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace lte {
namespace {

TEST(Crc32c, IsTheCheckValueOfItsStandard) {
  const std::string digits = "123456789";  // its usual check
  EXPECT_EQ(crc32c(std::vector<unsigned char>(digits.begin(), digits.end())), 0xE3069283U);
  EXPECT_EQ(crc32c(std::vector<unsigned char>(32, 0)), 0x8A9136AAU);  // RFC 3720, B.4
  EXPECT_EQ(crc32c(std::vector<unsigned char>(32, 0xFF)), 0x62A8AB43U);
  EXPECT_EQ(crc32c({}), 0U);
}

}  // namespace
}  // namespace lte
