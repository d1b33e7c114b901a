// 8-bit PNG for people to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lte/image/declared_size.h"
#include "lte/image/display_picture.h"
#include "lte/image/image.h"

namespace lte::image {

/// Writes 1- or 3-channel values already in display space, [0, 1], rounded to 8 bits. Atomic.
void write_png(const std::filesystem::path& path, const Image& display);
void write_png(const std::filesystem::path& path, const DisplayPicture& picture);

/// Values as a PNG holds them: [0, 1] rounded to 8 bits.
std::vector<uint8_t> to_bytes(const Image& display);

/// The same file in memory, for reports and logs that embed pictures.
/// @throws lte::Error unless the picture has 1 or 3 channels and at most 2^28 pixels.
std::vector<unsigned char> encode_png(const Image& display);
std::vector<unsigned char> encode_png(const DisplayPicture& picture);

/// Reads an 8- or 16-bit PNG or JPEG: its values / max, not linearized, in 3 channels, or 4 with
/// alpha.
/// @throws lte::Error naming the file if it cannot be decoded or declares more than `limit_pixels`.
Image read_png(const std::filesystem::path& path, int64_t limit_pixels = int64_t{1} << 28);

/// The same of bytes in memory.
/// @param name  of the file, for messages
Image decode_png(std::string_view file, const std::string& name, int64_t limit_pixels);

/// The size that its header gives, also where that is more than the decoder takes.
/// @throws lte::Error naming the file if the header is broken, or of another format.
DeclaredSize declared_png_size(std::string_view file, const std::string& name);

}  // namespace lte::image
