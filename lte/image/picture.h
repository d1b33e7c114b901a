// Picture files of every format that scene descriptions name.
#pragma once

#include <cstdint>
#include <filesystem>

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

}  // namespace lte::image
