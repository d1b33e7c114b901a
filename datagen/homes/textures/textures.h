// Procedural albedo textures of homes. Every texel's channels lie in [0.03, 0.85]; all but
// paintings, rugs and book spines are tileable. Colors are linear albedos, `size` texels an edge.
#pragma once

#include "datagen/common/raster.h"

namespace lte::datagen::homes {

/// The albedos of real diffuse surfaces, inset so that rounding to 8 bits stays within [0.03,
/// 0.85].
inline constexpr AlbedoRange kAlbedo{0.0315f, 0.845f};

/// Annual rings cut lengthwise, and fibres; the grain runs along u.
TexturePtr wood_grain(int size, const Rgb& base, Rng* rng);
/// Floor boards along u in `rows`, each with a grain of its own.
TexturePtr wood_planks(int size, const Rgb& base, int rows, Rng* rng);
/// Tiles with grout; `bond` shifts every other row by half a tile, `veined` makes them marble.
TexturePtr tiles(int size, const Rgb& tile, const Rgb& grout, int columns, int rows, bool bond,
                 bool veined, Rng* rng);
TexturePtr marble(int size, const Rgb& base, const Rgb& vein, Rng* rng);
TexturePtr plaster(int size, const Rgb& base, Rng* rng);

/// Plain weave of warp and weft, `threads` each.
TexturePtr weave(int size, const Rgb& warp, const Rgb& weft, int threads, Rng* rng);
enum class Cloth { Stripes, Checks, Dots, Herringbone };
inline constexpr int kCloths = 4;
TexturePtr printed_cloth(int size, Cloth cloth, const Rgb& ground, const Rgb& figure, int repeats,
                         Rng* rng);
/// Ornaments in half drop on a ground.
TexturePtr wallpaper(int size, const Rgb& ground, const Rgb& figure, int repeats, Rng* rng);

/// A bordered carpet with a field of medallions, or plain bands.
TexturePtr rug(int size, const Rgb& field, const Rgb& border, const Rgb& accent, Rng* rng);
/// A landscape, a still abstract or a botanical print, with a mat around it at times.
TexturePtr painting(int size, Rng* rng);
/// Spines of `count` books side by side along u, with bands and titles.
TexturePtr book_spines(int size, int count, Rng* rng);

}  // namespace lte::datagen::homes
