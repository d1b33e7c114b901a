// Pictures as displays take them.
#pragma once

#include <cstdint>
#include <vector>

namespace lte::image {

/// 8-bit sRGB, three bytes a pixel, rows from the top.
struct DisplayPicture {
  int width = 0, height = 0;
  std::vector<uint8_t> bytes;
};

}  // namespace lte::image
