// An image in memory: linear float32, row 0 at the top, channels interleaved.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/math.h"

namespace lte::image {

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;  ///< [height, width, channels]

  Image() = default;
  /// Zero-filled.
  /// @throws lte::Error unless all sizes are positive.
  Image(int width, int height, int channels);

  size_t number(int x, int y) const { return static_cast<size_t>(y) * width + x; }
  size_t offset(int x, int y) const { return number(x, y) * static_cast<size_t>(channels); }
  float* at(int x, int y) { return pixels.data() + offset(x, y); }
  const float* at(int x, int y) const { return pixels.data() + offset(x, y); }
  // Of images with three channels or more. Pixels are numbered row by row.
  Rgb rgb(size_t pixel) const {
    const float* p = pixels.data() + pixel * static_cast<size_t>(channels);
    return {p[0], p[1], p[2]};
  }
  Rgb rgb(int x, int y) const { return rgb(number(x, y)); }
  void set_rgb(size_t pixel, const Rgb& value) {
    float* p = pixels.data() + pixel * static_cast<size_t>(channels);
    p[0] = value.x;
    p[1] = value.y;
    p[2] = value.z;
  }
  void set_rgb(int x, int y, const Rgb& value) { set_rgb(number(x, y), value); }
};

}  // namespace lte::image
