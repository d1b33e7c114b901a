#include "lte/base/crc32c.h"

#include <array>

namespace lte {
namespace {

using Table = std::array<uint32_t, 256>;

/// The remainders of all bytes, so that a byte takes one look-up instead of eight shifts.
constexpr Table crc_table(uint32_t reflected_polynomial) {
  Table out{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit)
      value = value & 1 ? value >> 1 ^ reflected_polynomial : value >> 1;
    out[i] = value;
  }
  return out;
}

}  // namespace

uint32_t crc32c(std::span<const unsigned char> bytes) {
  static constexpr Table kTable = crc_table(0x82F63B78);
  uint32_t value = 0xFFFFFFFF;
  for (const unsigned char byte : bytes) value = kTable[(value ^ byte) & 0xFF] ^ value >> 8;
  return ~value;
}

}  // namespace lte
