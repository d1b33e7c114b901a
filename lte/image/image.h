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

  size_t offset(int x, int y) const {
    return (static_cast<size_t>(y) * width + x) * static_cast<size_t>(channels);
  }
  float* at(int x, int y) { return pixels.data() + offset(x, y); }
  const float* at(int x, int y) const { return pixels.data() + offset(x, y); }
  Rgb rgb(int x, int y) const { return {at(x, y)[0], at(x, y)[1], at(x, y)[2]}; }
  void set_rgb(int x, int y, const Rgb& value) {
    float* p = at(x, y);
    p[0] = value.x;
    p[1] = value.y;
    p[2] = value.z;
  }
};

}  // namespace lte::image
