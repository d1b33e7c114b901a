// Picture files of every format that scene descriptions name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "lte/image/declared_size.h"
#include "lte/image/image.h"

namespace lte::image {

struct Picture {
  Image image;  ///< 1, 3 or 4 channels
  /// True for values / max of an integer format, with whatever curve the file carries. Otherwise
  /// the values are linear floats, which may be any number and need not be finite.
  bool coded = false;
};

/// Reads PNG, JPEG, TGA (coded) and OpenEXR, PFM, Radiance HDR (floats), told apart by content;
/// TGA, which has no magic, by its extension.
/// @throws lte::Error naming the file: missing, of none of these formats, damaged, or declaring
/// more than `limit_pixels`.
Picture read_picture(const std::filesystem::path& path, int64_t limit_pixels = int64_t{1} << 28);

/// The same of bytes in memory.
/// @param name  of the file, for messages; a TGA is one by its extension
Picture decode_picture(std::string_view bytes, const std::string& name, int64_t limit_pixels);

/// The size that the header gives, without decoding anything.
/// @throws lte::Error naming the file: of none of the formats, or with a broken header.
DeclaredSize read_picture_size(std::string_view bytes, const std::string& name);

}  // namespace lte::image
