// Procedural albedo textures, all tileable but for pictures.
#pragma once

#include "datagen/common/raster.h"
#include "lte/base/math.h"
#include "lte/base/random.h"

namespace lte::datagen {

/// Colors are linear albedos; `size` texels an edge. Every texel lies in [0.01, 0.95].
TexturePtr make_planks(int size, const Rgb& wood, int planks, Rng* rng);
TexturePtr make_tiles(int size, const Rgb& tile, const Rgb& grout, int tiles, Rng* rng);
TexturePtr make_checker(int size, const Rgb& first, const Rgb& second, int cells);
TexturePtr make_noise(int size, const Rgb& base, float contrast, int cells, Rng* rng);
TexturePtr make_stripes(int size, const Rgb& first, const Rgb& second, int stripes);
/// An abstract painting: overlapping rectangles and discs over a gradient.
TexturePtr make_picture(int size, Rng* rng);

/// A color of the given hue (0 to 1) and saturation, scaled to `luminance` and kept within [0.01,
/// 0.95].
Rgb make_color(float hue, float saturation, float luminance);

}  // namespace lte::datagen
