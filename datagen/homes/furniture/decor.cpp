// Pictures, mirrors, rugs, curtains, coat racks.
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

/// A mitred frame around a rectangle on the wall, from z = 0 to `depth`; outer size width × height.
Mesh frame(float width, float height, float bar, float depth) {
  // Swept in the xz plane (profile: inwards, up), then turned upright.
  const std::vector<Vec2> path{
      {-width / 2, 0}, {width / 2, 0}, {width / 2, -height}, {-width / 2, -height}};
  const std::vector<Vec2> profile{{0, 0},
                                  {bar, 0},
                                  {bar, 0.5f * depth},
                                  {0.75f * bar, 0.7f * depth},
                                  {0.3f * bar, depth},
                                  {0, 0.9f * depth}};
  Mesh mesh = sweep(path, profile, true);
  Mesh upright;
  append(&upright, mesh, rotation(0, 90));
  return upright;
}

Piece framed(Kit* kit, const char* name, float width, float height, int canvas) {
  Piece piece;
  piece.name = name;
  const float bar = kit->draw(0.018f, 0.05f), depth = kit->draw(0.018f, 0.035f);
  piece.add(frame(width, height, bar, depth),
            kit->chance(0.5f) ? kit->palette->wood() : kit->palette->metal());
  piece.add(panel({-width / 2 + bar * 0.9f, bar * 0.9f, 0.4f * depth}, {width - 1.8f * bar, 0, 0},
                  {0, height - 1.8f * bar, 0}),
            canvas);
  return piece;
}

}  // namespace

Piece make_picture(Kit* kit, float width, float height) {
  return framed(kit, "picture", width, height, kit->palette->picture());
}

Piece make_mirror(Kit* kit, float width, float height) {
  return framed(kit, "mirror", width, height, kit->palette->mirror());
}

Piece make_rug(Kit* kit, float width, float depth) {
  Piece piece;
  piece.name = "rug";
  const int material = kit->palette->rug();
  const float cell = 0.06f / kit->detail.level, high = 0.01f;
  Mesh pile =
      rounded_box({-width / 2, 0, -depth / 2}, {width / 2, high, depth / 2}, 0.004f, 1, cell);
  for (size_t i = 0; i < pile.positions.size(); ++i) {
    const Vec3& p = pile.positions[i];
    pile.uvs[0][i] = {0.5f + p.x / width, 0.5f + p.z / depth};
  }
  piece.add(pile, material);
  if (!kit->chance(0.5f)) return piece;
  const int fringe = kit->palette->paper(), tassels = kit->detail.steps(depth, 0.025f);
  for (int i = 0; i < tassels; ++i) {
    const float z =
        -depth / 2 + depth * (static_cast<float>(i) + 0.5f) / static_cast<float>(tassels);
    for (const float side : {-1.0f, 1.0f}) {
      const float x = side * width / 2;
      kit->bar(&piece,
               {{x - side * 0.002f, 0.005f, z},
                {x + side * 0.03f, 0.004f, z + kit->draw(-0.005f, 0.005f)},
                {x + side * 0.055f, 0.0032f, z + kit->draw(-0.008f, 0.008f)}},
               0.003f, fringe);
    }
  }
  return piece;
}

Piece make_curtains(Kit* kit, float opening, float sill, float top) {
  Piece piece;
  piece.name = "curtains";
  piece.by_parts = true;
  const int cloth = kit->palette->curtain(), metal = kit->palette->metal();
  const float rod = top + 0.1f, out = 0.09f, half = opening / 2 + 0.2f;
  kit->bar(&piece, {{-half - 0.03f, rod, out}, {half + 0.03f, rod, out}}, 0.011f, metal);
  for (const float x : {-half, half}) {
    kit->turned(&piece,
                {{0, rod - 0.022f},
                 {0.02f, rod - 0.012f},
                 {0.024f, rod},
                 {0.02f, rod + 0.012f},
                 {0, rod + 0.022f}},
                metal, {x + (x < 0 ? -0.045f : 0.045f), 0, out}, false, 2);
    kit->bar(&piece, {{x, rod, 0.002f}, {x, rod, out}}, 0.007f, metal);
  }
  const float bottom = sill > 0.3f && kit->chance(0.6f) ? sill - 0.15f : 0.02f;
  const float width = kit->draw(0.22f, 0.3f), folds = kit->draw(55, 75), phase = kit->draw(0, 6);
  for (const float side : {-1.0f, 1.0f}) {
    const auto at = [&](float u, float v) {
      const float spread = 1 + 0.12f * v;
      const float x = side * (half - 0.01f - width * u * spread);
      const float wave = std::sin(folds * width * u + phase + 0.6f * std::sin(3 * v + phase));
      return Vec3{x, rod - 0.012f - v * (rod - bottom - 0.02f),
                  out + (0.026f + 0.012f * v) * wave * (0.6f + 0.4f * std::min(1.0f, 6 * v))};
    };
    piece.add(
        sheet(kit->detail.steps(width, 0.009f), kit->detail.steps(rod - bottom, 0.06f), at, 0.004f),
        cloth);
  }
  return piece;
}

Piece make_coat_rack(Kit* kit) {
  Piece piece;
  piece.name = "coat rack";
  const int wood = kit->palette->wood(), metal = kit->palette->metal();
  const float half = kit->draw(0.35f, 0.5f);
  kit->block(&piece, {-half, 0, 0.001f}, {half, 0.1f, 0.022f}, wood, 0.006f);
  const int hooks = 4;
  for (int i = 0; i < hooks; ++i) {
    const float x = -half + 2 * half * (static_cast<float>(i) + 0.5f) / hooks;
    kit->bar(
        &piece,
        smooth(std::vector<Vec3>{{x, 0.06f, 0.02f}, {x, 0.05f, 0.06f}, {x, 0.075f, 0.085f}}, 4),
        0.006f, metal);
    if (!kit->chance(0.5f)) continue;
    const float drop = kit->draw(0.7f, 1), w = kit->draw(0.09f, 0.105f), phase = kit->draw(0, 6);
    const auto at = [&](float u, float v) {  // a coat: a folded cloth, wider below
      const float s = 2 * u - 1, wide = w * (0.45f + 0.55f * std::min(1.0f, 3 * v));
      return Vec3{x + s * wide, 0.045f - drop * v - 0.05f * s * s * (1 - v),
                  0.075f + 0.03f * std::sqrt(std::max(0.0f, 1 - s * s)) * (0.4f + v) +
                      0.008f * std::sin(9 * s + phase) * v};
    };
    piece.add(sheet(kit->detail.steps(2 * w, 0.012f), kit->detail.steps(drop, 0.05f), at, 0.012f),
              kit->chance(0.5f) ? kit->palette->accent() : kit->palette->upholstery());
  }
  return piece;
}

}  // namespace lte::datagen::homes
