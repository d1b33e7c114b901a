// Wood, tiles, marble and plaster.
#include <cmath>

#include "datagen/homes/textures/textures.h"

namespace lte::datagen::homes {
namespace {

/// Rises from 0 to 1 over an annual ring, from early wood to late wood, which ends sharply.
class Rings {
 public:
  explicit Rings(Rng* rng)
      : count_(static_cast<float>(3 + rng->below(4))),
        amplitude_(rng->uniform(0.8f, 2.4f)),
        bend_(1, 3, 2, rng),
        fibre_(6, 160, 2, rng),
        blotch_(2, 5, 2, rng) {}

  /// Factor on the wood's color at (u, v), both not negative; periodic in both.
  float operator()(float u, float v) const {
    const float ring = fraction(count_ * v + amplitude_ * bend_(u, v));
    const float late = ring * ring * (1 - smooth_step((ring - 0.9f) / 0.1f));
    return (1 - 0.34f * late) * (1 + 0.16f * fibre_(u, v)) * (1 + 0.12f * blotch_(u, v));
  }

 private:
  static float smooth_step(float t) {
    t = std::clamp(t, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  }
  float count_, amplitude_;
  Noise bend_, fibre_, blotch_;
};

/// Thin veins along the zero crossings of turbulence.
class Veins {
 public:
  explicit Veins(Rng* rng) : wide_(3, 3, 4, rng), fine_(7, 7, 3, rng) {}
  float operator()(float u, float v) const {
    const float broad = std::pow(1 - std::abs(wide_(u, v)), 18.0f);
    const float thin = std::pow(1 - std::abs(fine_(u, v)), 40.0f);
    return std::min(1.0f, 0.8f * broad + 0.35f * thin);
  }

 private:
  Noise wide_, fine_;
};

}  // namespace

TexturePtr wood_grain(int size, const Rgb& base, Rng* rng) {
  const Rings rings(rng);
  return rasterize(
      size, [&](float u, float v) { return base * rings(u, v); }, kAlbedo);
}

TexturePtr wood_planks(int size, const Rgb& base, int rows, Rng* rng) {
  struct Row {
    float u, v, tone, joint, warmth;
  };
  std::vector<Row> boards(static_cast<size_t>(2 * rows));
  for (Row& b : boards) {
    b.u = rng->uniform();
    b.v = rng->uniform();
    b.tone = rng->uniform(0.82f, 1.16f);
    b.joint = rng->uniform();
    b.warmth = rng->uniform(-0.04f, 0.04f);
  }
  const Rings rings(rng);
  const float texel = 1 / static_cast<float>(size);
  return rasterize(
      size,
      [&](float u, float v) {
        const float at = v * static_cast<float>(rows);
        const auto row = std::min(static_cast<size_t>(at), static_cast<size_t>(rows - 1));
        const float across = at - static_cast<float>(row);
        const float along = fraction(u - boards[2 * row].joint + 1);
        const Row& board = boards[2 * row + (along < 0.5f ? 0 : 1)];
        const bool seam =
            across * texel * static_cast<float>(size) < 1.2f * texel * static_cast<float>(rows);
        const bool butt = fraction(2 * along) < 2.4f * texel;
        const float wood = rings(u + board.u, fraction(v + board.v)) * board.tone;
        const Rgb tint{1 + board.warmth, 1, 1 - board.warmth};
        return base * tint * (seam || butt ? 0.45f * wood : wood);
      },
      kAlbedo);
}

TexturePtr tiles(int size, const Rgb& tile, const Rgb& grout, int columns, int rows, bool bond,
                 bool veined, Rng* rng) {
  struct Cell {
    float tone, u, v;
  };
  std::vector<Cell> cells(static_cast<size_t>(columns * rows));
  for (Cell& c : cells) c = {rng->uniform(0.93f, 1.05f), rng->uniform(), rng->uniform()};
  const Veins veins(rng);
  const Noise cloud(4, 4, 4, rng);
  const float joint = 0.012f * static_cast<float>(std::max(columns, rows)) / 4 + 0.006f;
  return rasterize(
      size,
      [&](float u, float v) {
        const float y = v * static_cast<float>(rows);
        const int row = std::min(static_cast<int>(y), rows - 1);
        const float shift = bond && row % 2 ? 0.5f : 0.0f;
        const float x =
            fraction(u + shift / static_cast<float>(columns)) * static_cast<float>(columns);
        const int column = std::min(static_cast<int>(x), columns - 1);
        const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
        // Half of the grout on either side of a tile, in equal widths along both axes.
        const float jx = joint, jy = joint * static_cast<float>(rows) / static_cast<float>(columns);
        const float edge = std::min(std::min(fx, 1 - fx) / jx, std::min(fy, 1 - fy) / jy);
        if (edge < 1) return grout * (1 + 0.15f * cloud(u, v));
        const Cell& cell = cells[static_cast<size_t>(row * columns + column)];
        const float pillow = edge < 2 ? 0.94f : 1.0f;
        const Rgb body = tile * (cell.tone * pillow * (1 + 0.05f * cloud(u, v)));
        return veined ? mix(body, body * 0.62f, veins(u + cell.u, v + cell.v)) : body;
      },
      kAlbedo);
}

TexturePtr marble(int size, const Rgb& base, const Rgb& vein, Rng* rng) {
  const Veins veins(rng);
  const Noise cloud(3, 3, 5, rng);
  return rasterize(
      size,
      [&](float u, float v) {
        return mix(base * (1 + 0.08f * cloud(u, v)), vein, 0.7f * veins(u, v));
      },
      kAlbedo);
}

TexturePtr plaster(int size, const Rgb& base, Rng* rng) {
  const Noise wide(3, 3, 3, rng), fine(90, 90, 2, rng);
  return rasterize(
      size, [&](float u, float v) { return base * (1 + 0.025f * wide(u, v) + 0.03f * fine(u, v)); },
      kAlbedo);
}

}  // namespace lte::datagen::homes
