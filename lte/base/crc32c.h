// The checksum of TensorBoard's event files.
#pragma once

#include <cstdint>
#include <span>

namespace lte {

/// CRC-32C of RFC 3720, the reflected polynomial 0x82F63B78.
uint32_t crc32c(std::span<const unsigned char> bytes);

}  // namespace lte
