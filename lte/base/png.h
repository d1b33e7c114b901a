// PNG files of reports and training previews. Unlike lte/image, which compresses, it needs no other
// library: training runs where there is nothing but LibTorch and a compiler.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lte {

/// An 8-bit RGB picture as a PNG file (ISO/IEC 15948) whose pixels are stored, not compressed.
///
/// @param rgb  [height, width, 3], row 0 on top
/// @throws lte::Error if a side is not positive or `rgb` has another size.
std::vector<unsigned char> encode_stored_png(int width, int height,
                                             std::span<const unsigned char> rgb);

/// CRC-32 of ISO 3309 (reflected polynomial 0xEDB88320), or CRC-32C of RFC 3720 (0x82F63B78).
uint32_t crc32(std::span<const unsigned char> bytes);
uint32_t crc32c(std::span<const unsigned char> bytes);

}  // namespace lte
