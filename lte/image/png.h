// 8-bit PNG for people to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/image/image.h"

namespace lte::image {

/// Writes 1- or 3-channel values already in display space, [0, 1], rounded to 8 bits. Atomic.
void write_png(const std::filesystem::path& path, const Image& display);

/// The same bytes in memory, for reports and logs that embed pictures.
/// @throws lte::Error unless the picture has 1 or 3 channels and at most 2^28 pixels.
std::vector<unsigned char> encode_png(const Image& display);

/// Reads an 8- or 16-bit PNG or JPEG: its values / max, not linearized, in 3 channels, or 4 with
/// alpha.
/// @throws lte::Error naming the file if it cannot be decoded or declares more than `limit_pixels`.
Image read_png(const std::filesystem::path& path, int64_t limit_pixels = int64_t{1} << 28);

}  // namespace lte::image
