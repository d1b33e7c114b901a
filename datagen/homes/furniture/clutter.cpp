// Small things that stand on tables, shelves and worktops.
#include <algorithm>
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

Piece cup(Kit* kit) {
  Piece p;
  const float r = kit->draw(0.035f, 0.045f), h = kit->draw(0.07f, 0.1f),
              foot = kit->draw(0.6f, 1) * r;
  const int material = kit->palette->crockery();
  kit->turned(&p,
              {{0, 0},
               {foot, 0},
               {r, 0.6f * h},
               {r, h},
               {r - 0.004f, h},
               {r - 0.005f, 0.6f * h},
               {foot - 0.005f, 0.01f},
               {0, 0.008f}},
              material, {}, false, 2);
  kit->bar(&p,
           smooth(std::vector<Vec3>{{r - 0.003f, 0.8f * h, 0},
                                    {r + 0.025f, 0.75f * h, 0},
                                    {r + 0.022f, 0.35f * h, 0},
                                    {0.9f * r, 0.3f * h, 0}},
                  4),
           0.0045f, material);
  return p;
}

Piece bowl(Kit* kit, float r, bool fruit) {
  Piece p;
  const float h = r * kit->draw(0.4f, 0.6f);
  kit->turned(&p,
              {{0, 0},
               {0.4f * r, 0},
               {0.8f * r, 0.5f * h},
               {r, h},
               {0.96f * r, h + 0.002f},
               {0.76f * r, 0.55f * h},
               {0.36f * r, 0.12f * h},
               {0, 0.1f * h}},
              kit->palette->crockery());
  if (!fruit) return p;
  for (int i = 0; i < 6; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / 5, f = 0.27f * r,
                out = i == 5 ? 0 : 0.46f * r;
    const float y = i == 5 ? 0.95f * h : 0.5f * h;
    kit->turned(&p,
                {{0, 0},
                 {0.6f * f, 0.08f * f},
                 {f, 0.9f * f},
                 {0.75f * f, 1.65f * f},
                 {0.2f * f, 1.85f * f},
                 {0, 1.75f * f}},
                i % 2 ? kit->palette->accent() : kit->palette->pot(),
                {out * std::cos(a), y, out * std::sin(a)});
  }
  return p;
}

Piece bottle(Kit* kit) {
  Piece p;
  const float r = kit->draw(0.03f, 0.042f), h = kit->draw(0.2f, 0.32f);
  kit->turned(&p,
              {{0, 0},
               {r, 0},
               {r, 0.05f * h},
               {r, 0.55f * h},
               {0.4f * r, 0.75f * h},
               {0.36f * r, 0.97f * h},
               {0.42f * r, h},
               {0, h}},
              kit->palette->glass_like(), {}, false, 3);
  return p;
}

Piece vase(Kit* kit) {
  Piece p;
  const float r = kit->draw(0.05f, 0.08f), h = kit->draw(0.16f, 0.28f),
              neck = kit->draw(0.3f, 0.6f) * r, belly = kit->draw(0.25f, 0.6f);
  kit->turned(&p,
              {{0, 0},
               {0.55f * r, 0},
               {r, belly * h},
               {neck, 0.88f * h},
               {1.25f * neck, h},
               {1.1f * neck, h},
               {0.85f * neck, 0.88f * h},
               {0.8f * r, belly * h},
               {0, 0.1f * h}},
              kit->palette->pot());
  const int stems = kit->chance(0.6f) ? kit->count(4, 8) : 0;
  for (int i = 0; i < stems; ++i) {
    const float a = 2.4f * static_cast<float>(i), out = kit->draw(0.02f, 0.07f),
                up = h + kit->draw(0.1f, 0.2f);
    const Vec3 tip{out * std::cos(a), up, out * std::sin(a)};
    kit->bar(&p, {{0, 0.5f * h, 0}, {0.3f * tip.x, h, 0.3f * tip.z}, tip}, 0.002f,
             kit->palette->leaf());
    kit->turned(&p, {{0, -0.01f}, {0.012f, 0}, {0.025f, 0.02f}, {0.014f, 0.026f}, {0, 0.022f}},
                kit->palette->accent(), tip);
  }
  return p;
}

/// A stack of lying books: covers above and below a block of pages.
Piece book_stack(Kit* kit) {
  Piece p;
  float y = 0;
  const int books = kit->count(1, 4);
  for (int i = 0; i < books; ++i) {
    const float thick = kit->draw(0.015f, 0.035f), w = kit->draw(0.13f, 0.17f) / 2,
                d = kit->draw(0.19f, 0.24f) / 2;
    const Affine turn = rotation(1, kit->draw(-14, 14));
    const float column = (static_cast<float>(kit->rng.below(kBookSpines)) + 0.5f) / kBookSpines;
    for (const float at : {y, y + thick - 0.003f}) {
      Mesh cover = rounded_box({-w, at, -d}, {w, at + 0.003f, d}, 0.0012f, 1);
      for (Vec2& uv : cover.uvs[0]) uv = {column, 0.9f};
      p.add(cover, kit->palette->books(), turn);
    }
    Mesh spine = rounded_box({-w, y + 0.003f, -d}, {-w + 0.003f, y + thick - 0.003f, d}, 0.001f, 1);
    fit_uvs(&spine, {column - 0.3f / kBookSpines, 0}, {column + 0.3f / kBookSpines, 1});
    p.add(spine, kit->palette->books(), turn);
    p.add(rounded_box({-w + 0.003f, y + 0.003f, -d + 0.004f},
                      {w - 0.004f, y + thick - 0.003f, d - 0.004f}, 0.001f, 1),
          kit->palette->paper(), turn);
    y += thick;
  }
  return p;
}

Piece monitor(Kit* kit) {
  Piece p;
  const int black = kit->palette->black();
  const float half = kit->draw(0.26f, 0.36f), high = 1.13f * half, y = 0.1f;
  kit->turned(&p, {{0, 0}, {0.11f, 0}, {0.11f, 0.008f}, {0.02f, 0.02f}, {0.016f, 0.2f}, {0, 0.2f}},
              black, {0, 0, -0.05f}, false, 1);
  kit->block(&p, {-half, y, -0.03f}, {half, y + high, 0}, black, 0.006f);
  p.add(
      panel({-half + 0.01f, y + 0.015f, 0.0006f}, {2 * half - 0.02f, 0, 0}, {0, high - 0.025f, 0}),
      kit->palette->screen());
  kit->block(&p, {-0.2f, 0, 0.14f}, {0.2f, 0.014f, 0.27f}, black, 0.004f);
  for (int row = 0; row < 4; ++row)
    for (int key = 0; key < 12; ++key)
      kit->block(&p,
                 {-0.19f + 0.0318f * static_cast<float>(key), 0.013f,
                  0.148f + 0.029f * static_cast<float>(row)},
                 {-0.164f + 0.0318f * static_cast<float>(key), 0.02f,
                  0.172f + 0.029f * static_cast<float>(row)},
                 kit->palette->metal(), 0.003f);
  return p;
}

Piece laptop(Kit* kit) {
  Piece p;
  const int gray = kit->palette->chrome();
  kit->block(&p, {-0.16f, 0, -0.11f}, {0.16f, 0.014f, 0.11f}, gray, 0.005f);
  const Affine lid = translation({0, 0.012f, -0.105f}) * rotation(0, -15);
  kit->block(&p, {-0.16f, 0, -0.004f}, {0.16f, 0.215f, 0.004f}, gray, 0.003f, lid);
  Mesh screen;
  append(&screen, panel({-0.15f, 0.01f, 0.0045f}, {0.3f, 0, 0}, {0, 0.195f, 0}), lid);
  p.add(screen, kit->palette->screen());
  kit->block(&p, {-0.14f, 0.0135f, -0.08f}, {0.14f, 0.0155f, 0.02f}, kit->palette->black(),
             0.0009f);
  return p;
}

Piece saucepan(Kit* kit) {
  Piece p;
  const int metal = kit->palette->chrome();
  const float r = kit->draw(0.08f, 0.11f), h = kit->draw(0.08f, 0.14f);
  kit->turned(&p, {{0, 0}, {r, 0}, {r, h}, {r - 0.003f, h}, {r - 0.003f, 0.01f}, {0, 0.01f}}, metal,
              {}, false, 1);
  kit->turned(&p,
              {{0, h},
               {r + 0.004f, h + 0.001f},
               {r, h + 0.01f},
               {0.4f * r, h + 0.03f},
               {0.02f, h + 0.03f},
               {0.02f, h + 0.05f},
               {0, h + 0.052f}},
              metal, {}, false, 2);
  for (const float side : {-1.0f, 1.0f})
    kit->bar(&p,
             smooth(std::vector<Vec3>{{side * (r - 0.003f), 0.8f * h, -0.03f},
                                      {side * (r + 0.03f), 0.82f * h, 0},
                                      {side * (r - 0.003f), 0.8f * h, 0.03f}},
                    5),
             0.005f, kit->palette->black());
  return p;
}

Piece turned_thing(Kit* kit, Thing thing) {
  Piece p;
  if (thing == Thing::Plate) {
    const float r = kit->draw(0.11f, 0.14f);
    kit->turned(
        &p,
        {{0, 0}, {0.6f * r, 0}, {r, 0.018f}, {0.99f * r, 0.022f}, {0.6f * r, 0.007f}, {0, 0.006f}},
        kit->palette->crockery(), {}, false, 2);
  } else if (thing == Thing::Candle) {
    const float r = kit->draw(0.025f, 0.04f), h = kit->draw(0.06f, 0.16f);
    kit->turned(&p, {{0, 0}, {1.6f * r, 0}, {1.7f * r, 0.012f}, {1.2f * r, 0.01f}, {0, 0.01f}},
                kit->palette->metal(), {}, false, 1);
    kit->turned(&p, {{0, 0.01f}, {r, 0.01f}, {r, h}, {0.85f * r, h + 0.003f}, {0, h - 0.004f}},
                kit->palette->paper(), {}, false, 1);
  } else if (thing == Thing::Soap) {
    kit->turned(
        &p, {{0, 0}, {0.033f, 0}, {0.034f, 0.1f}, {0.015f, 0.125f}, {0.012f, 0.15f}, {0, 0.15f}},
        kit->palette->crockery(), {}, false, 2);
    kit->bar(&p, {{0, 0.14f, 0}, {0, 0.17f, 0}, {0, 0.172f, 0.035f}}, 0.005f,
             kit->palette->chrome());
  } else {  // a clock
    const int metal = kit->palette->metal();
    Mesh body = lathe(smooth(std::vector<Vec2>{{0, -0.02f},
                                               {0.07f, -0.02f},
                                               {0.075f, 0.018f},
                                               {0.066f, 0.02f},
                                               {0.064f, 0.012f},
                                               {0, 0.012f}},
                             2),
                      kit->detail.turn(0.075f));
    p.add(body, metal, translation({0, 0.08f, 0}) * rotation(0, 90));
    kit->block(&p, {-0.04f, 0, -0.02f}, {0.04f, 0.012f, 0.02f}, metal);
    kit->block(&p, {-0.003f, 0.075f, 0.0125f}, {0.003f, 0.13f, 0.0145f}, kit->palette->paper(),
               0.0008f);
  }
  return p;
}

Piece build(Kit* kit, Thing thing) {
  switch (thing) {
    case Thing::Cup:
      return cup(kit);
    case Thing::Bowl:
      return bowl(kit, kit->draw(0.06f, 0.11f), false);
    case Thing::Fruit:
      return bowl(kit, kit->draw(0.13f, 0.17f), true);
    case Thing::Bottle:
      return bottle(kit);
    case Thing::Vase:
      return vase(kit);
    case Thing::Books:
      return book_stack(kit);
    case Thing::Plant:
      return make_plant(kit, kit->draw(0.22f, 0.38f));
    case Thing::Lamp:
      return make_table_lamp(kit);
    case Thing::Monitor:
      return monitor(kit);
    case Thing::Laptop:
      return laptop(kit);
    case Thing::Pot:
      return saucepan(kit);
    default:
      return turned_thing(kit, thing);
  }
}

}  // namespace

Piece make_thing(Kit* kit, Thing thing) {
  static constexpr const char* kNames[] = {
      "cup",   "bowl",        "bottle",     "vase",    "books",  "candle",   "fruit bowl", "plate",
      "clock", "small plant", "table lamp", "monitor", "laptop", "saucepan", "soap"};
  Piece piece = build(kit, thing);
  piece.name = kNames[static_cast<int>(thing)];
  return piece;
}

}  // namespace lte::datagen::homes
