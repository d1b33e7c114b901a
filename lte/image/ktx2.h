// Writes KTX2 textures of light: uncompressed RGB9E5 and half floats; 2D, 2D arrays and 3D; one mip
// level.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lte/base/math.h"

namespace lte::image {

enum class Ktx2Format {
  Rgb9e5,  ///< E5B9G9R9_UFLOAT_PACK32: 4 bytes a texel, 9 bits of mantissa, 0 to 65408
  Rgba16f  ///< R16G16B16A16_SFLOAT: 8 bytes a texel, alpha 1
};

struct Ktx2 {
  Ktx2Format format = Ktx2Format::Rgb9e5;
  int width = 0, height = 0;
  int depth = 0;            ///< 0 unless it is 3D
  int layers = 0;           ///< 0 unless it is an array; not both
  std::vector<Rgb> texels;  ///< [max(layers, depth, 1), height, width], linear Rec.709
};

/// The word of a color, red in the lowest bits: the shared exponent of OpenGL's and Vulkan's
/// specifications, mantissas rounded to the nearest, halves up. Negative values become 0, values
/// beyond 65408 that.
uint32_t to_rgb9e5(const Rgb& color);

/// Writes the texels as the format holds them, atomically. Halves saturate at 65504.
/// @throws lte::Error naming the file if sizes are not positive or do not fit the texels, a texel
///         is not finite, or the file cannot be written.
void write_ktx2(const std::filesystem::path& path, const Ktx2& texture);

}  // namespace lte::image
