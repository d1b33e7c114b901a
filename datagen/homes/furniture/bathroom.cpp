// Tub, vanity with basin, toilet, towel rail.
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

/// A spout over (x, z): a foot, a bend and a lever.
void add_tap(Kit* kit, Piece* piece, const Vec3& foot, float high, float reach) {
  const int chrome = kit->palette->chrome();
  kit->turned(piece, {{0, 0}, {0.024f, 0}, {0.02f, 0.02f}, {0, 0.024f}}, chrome, foot, false, 2);
  kit->bar(piece,
           smooth(std::vector<Vec3>{foot + Vec3{0, 0.01f, 0}, foot + Vec3{0, 0.8f * high, 0},
                                    foot + Vec3{0, high, 0.35f * reach},
                                    foot + Vec3{0, 0.75f * high, reach}},
                  5),
           0.012f, chrome);
  kit->bar(piece, {foot + Vec3{0, 0.45f * high, 0}, foot + Vec3{0.06f, 0.6f * high, 0}}, 0.006f,
           chrome);
}

/// A vessel with thick walls, of unit radius; heights in metres.
Mesh vessel(Kit* kit, float height, float base, float power) {
  const float h = height;
  Mesh mesh = lathe(smooth(std::vector<Vec2>{{0, 0},
                                             {base, 0},
                                             {base + 0.6f * (1 - base), 0.3f * h},
                                             {0.98f, 0.93f * h},
                                             {1, h},
                                             {0.93f, h + 0.004f},
                                             {0.9f, 0.92f * h},
                                             {base + 0.45f * (1 - base), 0.35f * h},
                                             {0.8f * base, 0.16f * h},
                                             {0, 0.13f * h}},
                           2 + static_cast<int>(2 * kit->detail.level)),
                    2 * kit->detail.turn(0.4f));
  square_off(&mesh, power);
  return mesh;
}

}  // namespace

Piece make_tub(Kit* kit) {
  Piece piece;
  piece.name = "tub";
  const float x = kit->draw(0.78f, 0.86f), z = kit->draw(0.36f, 0.4f),
              high = kit->draw(0.54f, 0.6f);
  const int white = kit->palette->ceramic();
  if (kit->chance(0.4f)) {  // free-standing
    piece.add(vessel(kit, high, 0.72f, 2.6f), white, scaling({x, 1, z}));
  } else {  // built in behind a tiled apron
    Mesh bowl = lathe(smooth(std::vector<Vec2>{{0, 0.06f},
                                               {0.86f, 0.1f},
                                               {0.9f, high - 0.05f},
                                               {0.99f, high - 0.04f},
                                               {1, high - 0.01f},
                                               {0.98f, high},
                                               {0.9f, high},
                                               {0.86f, high - 0.04f},
                                               {0.8f, 0.2f},
                                               {0.6f, 0.13f},
                                               {0, 0.12f}},
                             3),
                      2 * kit->detail.turn(0.5f));
    square_off(&bowl, 9);
    piece.add(bowl, white, scaling({x, 1, z}));
    const int tile = kit->palette->wall_tiles();
    kit->block(&piece, {-x, 0, z - 0.03f}, {x, high - 0.04f, z}, tile, 0.003f);
    for (const float side : {-x, x - 0.03f})
      kit->block(&piece, {side, 0, -z}, {side + 0.03f, high - 0.04f, z - 0.03f}, tile, 0.003f);
  }
  kit->turned(&piece, {{0, 0.125f}, {0.03f, 0.125f}, {0.028f, 0.135f}, {0, 0.136f}},
              kit->palette->chrome(), {0.55f * x, 0, 0}, false, 1);
  add_tap(kit, &piece, {x - 0.04f, high - 0.005f, -0.05f}, 0.16f, 0.05f);
  return piece;
}

Piece make_vanity(Kit* kit) {
  Piece piece;
  piece.name = "vanity";
  const float x = kit->draw(0.35f, 0.6f), z = 0.23f, top = kit->draw(0.72f, 0.78f);
  const int front = kit->palette->front(), worktop = kit->palette->worktop();
  kit->cabinet(&piece, {-x, 0, -z}, {x, top - 0.03f, z}, x > 0.45f ? 2 : 1,
               kit->chance(0.5f) ? 2 : 0, front, front, kit->count(0, 5));
  kit->block(&piece, {-x - 0.01f, top - 0.03f, -z}, {x + 0.01f, top, z + 0.015f}, worktop, 0.005f);
  const float bowl = kit->draw(0.19f, 0.22f), high = kit->draw(0.11f, 0.15f);
  const float at = x > 0.5f ? kit->draw(-0.15f, 0.15f) : 0;
  piece.add(vessel(kit, high, 0.55f, kit->chance(0.5f) ? 2 : 4), kit->palette->ceramic(),
            translation({at, top, 0.03f}) * scaling({bowl, 1, 0.17f}));
  add_tap(kit, &piece, {at, top, -z + 0.05f}, high + 0.14f, 0.13f);
  if (x - at - bowl > 0.12f)
    piece.tops.push_back(
        {{at + bowl + 0.02f, top, -z + 0.03f}, {x - 0.01f, top + 0.3f, z - 0.02f}});
  if (x + at - bowl > 0.12f)
    piece.tops.push_back(
        {{-x + 0.01f, top, -z + 0.03f}, {at - bowl - 0.02f, top + 0.3f, z - 0.02f}});
  return piece;
}

Piece make_toilet(Kit* kit) {
  Piece piece;
  piece.name = "toilet";
  const int white = kit->palette->ceramic();
  const float rim = 0.4f, z = 0.08f;
  Mesh bowl = lathe(smooth(std::vector<Vec2>{{0, 0},
                                             {0.62f, 0},
                                             {0.6f, 0.12f},
                                             {0.8f, 0.3f},
                                             {1, rim - 0.03f},
                                             {1, rim},
                                             {0.85f, rim},
                                             {0.8f, rim - 0.05f},
                                             {0.4f, 0.24f},
                                             {0, 0.2f}},
                           3),
                    2 * kit->detail.turn(0.2f));
  square_off(&bowl, 2.4f);
  piece.add(bowl, white, translation({0, 0, z}) * scaling({0.18f, 1, 0.25f}));
  Mesh seat = lathe({{0.6f, rim + 0.002f},
                     {1.02f, rim + 0.002f},
                     {1.04f, rim + 0.014f},
                     {1, rim + 0.024f},
                     {0.62f, rim + 0.022f}},
                    2 * kit->detail.turn(0.2f), true);
  square_off(&seat, 2.4f);
  piece.add(seat, white, translation({0, 0, z}) * scaling({0.18f, 1, 0.25f}));
  kit->block(&piece, {-0.12f, 0, -0.32f}, {0.12f, rim - 0.02f, -0.1f}, white, 0.03f);
  kit->block(&piece, {-0.19f, rim - 0.02f, -0.34f}, {0.19f, 0.78f, -0.18f}, white, 0.03f);
  kit->block(&piece, {-0.2f, 0.78f, -0.345f}, {0.2f, 0.81f, -0.17f}, white, 0.012f);
  kit->turned(&piece, {{0, 0.808f}, {0.022f, 0.808f}, {0.02f, 0.818f}, {0, 0.82f}},
              kit->palette->chrome(), {0, 0, -0.26f}, false, 1);
  // The lid leans against the cistern.
  Mesh lid = rounded_box({-0.18f, 0, -0.012f}, {0.18f, 0.42f, 0.012f}, 0.011f, kit->detail.bevel());
  piece.add(lid, white, translation({0, rim + 0.03f, -0.145f}) * rotation(0, -4));
  return piece;
}

Piece make_towel_rail(Kit* kit) {
  Piece piece;
  piece.name = "towel rail";
  const float half = kit->draw(0.25f, 0.35f), drop = kit->draw(0.45f, 0.6f), out = 0.08f;
  const int chrome = kit->palette->chrome();
  kit->bar(&piece, {{-half, 0, out}, {half, 0, out}}, 0.008f, chrome);
  for (const float x : {-half + 0.01f, half - 0.01f})
    kit->bar(&piece, {{x, 0, 0.002f}, {x, 0, out}}, 0.007f, chrome);
  const float w = half * kit->draw(0.5f, 0.75f), phase = kit->draw(0, 6);
  const auto at = [&](float u, float v) {
    const float s = (v - 0.45f) * 2 * drop, x = (2 * u - 1) * w, r = 0.02f;
    const float fold = 0.006f * std::sin(40 * x + phase) * std::min(1.0f, std::abs(s) / 0.2f);
    const float a = std::min(std::abs(s), 0.5f * kPi * r), side = s < 0 ? -1.0f : 1.0f;
    return Vec3{x, r * std::cos(a / r) - std::max(0.0f, std::abs(s) - a),
                out + side * r * std::sin(a / r) + fold};
  };
  piece.add(
      sheet(kit->detail.steps(2 * w, 0.015f), kit->detail.steps(2 * drop, 0.025f), at, 0.007f),
      kit->palette->accent());
  return piece;
}

}  // namespace lte::datagen::homes
