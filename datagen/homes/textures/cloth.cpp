// Weaves, printed cloth, wallpaper and rugs.
#include <cmath>

#include "datagen/homes/textures/textures.h"

namespace lte::datagen::homes {
namespace {

/// A rosette of `petals` about the middle of the unit square: 1 inside, 0 outside.
float rosette(float x, float y, int petals, float radius) {
  const float r = std::hypot(x, y), phi = std::atan2(y, x);
  const float rim = radius * (0.68f + 0.32f * std::cos(static_cast<float>(petals) * phi));
  if (r < 0.18f * radius) return 0;
  return r < rim ? 1.0f : 0.0f;
}

}  // namespace

TexturePtr weave(int size, const Rgb& warp, const Rgb& weft, int threads, Rng* rng) {
  const Noise slub(8, 8, 3, rng), fuzz(threads, threads, 1, rng);
  return rasterize(
      size,
      [&](float u, float v) {
        const float x = u * static_cast<float>(threads), y = v * static_cast<float>(threads);
        const bool over = (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
        const float across = over ? fraction(x) : fraction(y);
        const float round = 0.72f + 0.28f * std::sin(kPi * across);  // threads are round
        return (over ? warp : weft) * (round * (1 + 0.1f * slub(u, v) + 0.08f * fuzz(u, v)));
      },
      kAlbedo);
}

TexturePtr printed_cloth(int size, Cloth cloth, const Rgb& ground, const Rgb& figure, int repeats,
                         Rng* rng) {
  const Noise slub(40, 40, 2, rng);
  const float wide = rng->uniform(0.2f, 0.5f);
  const auto coverage = [&](float u, float v) {
    const float x = fraction(u * static_cast<float>(repeats)),
                y = fraction(v * static_cast<float>(repeats));
    switch (cloth) {
      case Cloth::Stripes:
        return x < wide || (x > 0.5f + wide / 2 && x < 0.56f + wide / 2) ? 1.0f : 0.0f;
      case Cloth::Checks:
        return 0.5f * (x < wide) + 0.5f * (y < wide);
      case Cloth::Dots: {
        const float shift = static_cast<int>(v * static_cast<float>(2 * repeats)) % 2 ? 0.5f : 0.0f;
        return std::hypot(fraction(x + shift) - 0.5f, fraction(2 * y) / 2 - 0.25f) < 0.4f * wide
                   ? 1.0f
                   : 0.0f;
      }
      case Cloth::Herringbone: {
        const float zig = x < 0.5f ? x : 1 - x;
        return fraction(4 * (y + zig)) < 0.5f ? 1.0f : 0.0f;
      }
    }
    return 0.0f;
  };
  return rasterize(
      size,
      [&](float u, float v) {
        return mix(ground, figure, coverage(u, v)) * (1 + 0.08f * slub(u, v));
      },
      kAlbedo);
}

TexturePtr wallpaper(int size, const Rgb& ground, const Rgb& figure, int repeats, Rng* rng) {
  const int petals = 4 + static_cast<int>(rng->below(5));
  const float radius = rng->uniform(0.22f, 0.36f);
  const bool striped = rng->below(3) == 0;
  const Noise paper(60, 60, 2, rng);
  return rasterize(
      size,
      [&](float u, float v) {
        const float x = u * static_cast<float>(repeats), y = v * static_cast<float>(repeats);
        const float fx = fraction(x) - 0.5f, fy = fraction(y) - 0.5f;
        const float gx = fraction(x + 0.5f) - 0.5f, gy = fraction(y + 0.5f) - 0.5f;
        float cover = 0;
        if (striped) {
          cover =
              std::abs(fx) < 0.22f ? 1.0f : (std::abs(std::abs(fx) - 0.3f) < 0.02f ? 1.0f : 0.0f);
        } else {
          cover = std::max(rosette(fx, fy, petals, radius), rosette(gx, gy, 4, 0.6f * radius));
          // Stems that join one row to the next.
          const float stem = 0.12f * std::sin(2 * kPi * y);
          if (std::abs(fx - stem) < 0.018f) cover = 1;
        }
        return mix(ground, figure, cover) * (1 + 0.02f * paper(u, v));
      },
      kAlbedo);
}

TexturePtr rug(int size, const Rgb& field, const Rgb& border, const Rgb& accent, Rng* rng) {
  const Noise pile(120, 120, 2, rng), wear(4, 4, 3, rng);
  const int style = static_cast<int>(rng->below(3));
  const int petals = 4 + 2 * static_cast<int>(rng->below(4));
  const int bands = 4 + static_cast<int>(rng->below(5));
  const auto pattern = [&](float u, float v) -> Rgb {
    const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
    const float x = u - 0.5f, y = v - 0.5f;
    if (style == 1) {  // bands across
      const float at = fraction(v * static_cast<float>(bands));
      return at < 0.45f ? field : (at < 0.55f ? accent : (at < 0.9f ? border : accent));
    }
    if (style == 2) return edge < 0.05f ? border : field;  // plain with a bound edge
    if (edge < 0.02f) return border * 0.6f;
    if (edge < 0.1f) {  // a border of small rosettes
      const float along = (edge == u || edge == 1 - u ? v : u) * 16;
      return rosette(fraction(along) - 0.5f, (edge - 0.06f) / 0.08f, 4, 0.42f) > 0 ? accent
                                                                                   : border;
    }
    if (edge < 0.115f) return accent;
    if (rosette(x, y * 1.3f, petals, 0.32f) > 0) return border;
    if (rosette(x, y * 1.3f, petals, 0.36f) > 0) return accent;
    const float gx = fraction(u * 7) - 0.5f, gy = fraction(v * 7) - 0.5f;
    return rosette(gx, gy, 4, 0.26f) > 0 ? mix(field, accent, 0.6f) : field;
  };
  return rasterize(
      size,
      [&](float u, float v) {
        return pattern(u, v) * (1 + 0.18f * pile(u, v) + 0.08f * wear(u, v));
      },
      kAlbedo);
}

}  // namespace lte::datagen::homes
