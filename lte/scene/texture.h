// Textures: 8-bit or float texels with a mip chain, decoded to linear before filtering.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::scene {

enum class Wrap { Repeat, MirroredRepeat, ClampToEdge };

/// Three color channels. sRGB texels are decoded to linear before any filtering; alpha is dropped.
class Texture {
 public:
  /// @param texels  [height, width, 3] 8-bit; `srgb` tells whether they carry the sRGB curve
  Texture(int width, int height, std::vector<uint8_t> texels, bool srgb);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  size_t size_bytes() const;
  /// [height, width, 3], as they came.
  const std::vector<uint8_t>& texels() const { return levels_.front().coded; }
  bool srgb() const { return srgb_; }

  /// Bilinear lookup in the two mip levels around `footprint` texels of level 0 (<= 1: the finest),
  /// blended. UV (0, 0) is the top left of the picture, as in glTF.
  Rgb sample(const Vec2& uv, Wrap wrap_u, Wrap wrap_v, float footprint) const;

 private:
  struct Level {
    int width, height;
    std::vector<uint8_t> coded;  ///< level 0: texels as they came
    std::vector<uint16_t> half;  ///< coarser levels: linear, 16-bit fixed point of [0, 1]; padded
  };
  Rgb bilinear(const Level& level, const Vec2& uv, Wrap wrap_u, Wrap wrap_v) const;

  std::vector<Level> levels_;
  bool srgb_;
  const float* decode_;  ///< linear value of each code of level 0; of static storage
};

}  // namespace lte::scene
