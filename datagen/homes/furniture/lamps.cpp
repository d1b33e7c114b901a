// Lamps: stands, shades, bulbs. A lit lamp has one emitter, its bulb or its glowing shade.
#include <cmath>

#include "datagen/common/daylight.h"
#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

/// The flux of a lamp relative to that of a ceiling light of 0.36 m².
constexpr float kPanelArea = 0.36f;

Rgb lamp_radiance(Kit* kit, float area) {
  const float share = kit->draw(0.05f, 0.18f);
  return light_tint(kit->draw(0.5f, 1)) * (kit->radiance * share * kPanelArea / area);
}

void add_bulb(Kit* kit, Piece* piece, const Vec3& at, float radius, bool lit) {
  const int turn = std::max(8, kit->detail.turn(radius));
  const int material =
      lit ? kit->palette->emitter("bulb", lamp_radiance(kit, 4 * kPi * radius * radius))
          : kit->palette->paper();
  piece->add(sphere(radius, turn), material, translation(at));
}

/// An open cone or drum, a bulb in it, and a spider that holds it.
void add_shade(Kit* kit, Piece* piece, const Vec3& at, float low_radius, float top_radius,
               float height) {
  const bool lit = kit->chance(kit->lit_share), glows = lit && kit->chance(0.7f);
  const float t = 0.003f, h = height;
  const std::vector<Vec2> loop{
      {low_radius - t, 0}, {low_radius, 0}, {top_radius, h}, {top_radius - t, h}};
  const float area = 2 * kPi * (low_radius + top_radius) * h;  // inside and outside
  const int material = glows
                           ? kit->palette->emitter("shade", lamp_radiance(kit, area))
                           : (kit->chance(0.6f) ? kit->palette->bedding() : kit->palette->accent());
  kit->turned(piece, loop, material, at, true);
  add_bulb(kit, piece, at + Vec3{0, 0.45f * h, 0}, std::min(0.055f, 0.45f * top_radius),
           lit && !glows);
  const int metal = kit->palette->metal();
  for (int i = 0; i < 3; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / 3, r = top_radius - 0.004f;
    kit->bar(piece,
             {at + Vec3{0, 0.9f * h, 0}, at + Vec3{r * std::cos(a), 0.97f * h, r * std::sin(a)}},
             0.0025f, metal);
  }
}

}  // namespace

Piece make_floor_lamp(Kit* kit) {
  Piece lamp;
  lamp.name = "floor lamp";
  const int metal = kit->palette->metal();
  const float high = kit->draw(1.35f, 1.6f), r = kit->draw(0.16f, 0.22f),
              h = kit->draw(0.2f, 0.28f);
  if (kit->chance(0.5f)) {
    kit->turned(&lamp,
                {{0, 0},
                 {0.14f, 0},
                 {0.14f, 0.015f},
                 {0.03f, 0.03f},
                 {0.012f, 0.06f},
                 {0.012f, high - 0.05f},
                 {0, high - 0.05f}},
                metal, {}, false, 1);
  } else {  // three legs
    const int wood = kit->palette->wood();
    for (int i = 0; i < 3; ++i) {
      const float a = 2 * kPi * static_cast<float>(i) / 3 + 0.5f, c = std::cos(a), s = std::sin(a);
      kit->bar(&lamp, {{0.2f * c, 0.002f, 0.2f * s}, {0.02f * c, high - 0.2f, 0.02f * s}}, 0.012f,
               wood);
    }
    kit->turned(&lamp,
                {{0, high - 0.26f},
                 {0.03f, high - 0.26f},
                 {0.03f, high - 0.18f},
                 {0.01f, high - 0.16f},
                 {0.01f, high - 0.05f},
                 {0, high - 0.05f}},
                metal, {}, false, 1);
  }
  add_shade(kit, &lamp, {0, high - h / 2, 0}, r, r * kit->draw(0.65f, 1), h);
  return lamp;
}

Piece make_table_lamp(Kit* kit) {
  Piece lamp;
  lamp.name = "table lamp";
  const float foot = kit->draw(0.05f, 0.075f), high = kit->draw(0.2f, 0.28f),
              h = kit->draw(0.14f, 0.19f);
  const float belly = foot * kit->draw(0.8f, 1.15f);
  kit->turned(&lamp,
              {{0, 0},
               {foot, 0},
               {0.9f * foot, 0.012f},
               {belly, 0.35f * high},
               {0.3f * foot, 0.75f * high},
               {0.007f, 0.85f * high},
               {0.006f, high},
               {0, high}},
              kit->chance(0.5f) ? kit->palette->crockery() : kit->palette->metal());
  const float r = kit->draw(0.11f, 0.15f);
  add_shade(kit, &lamp, {0, high - 0.02f, 0}, r, r * kit->draw(0.6f, 0.95f), h);
  return lamp;
}

Piece make_pendant(Kit* kit, float ceiling_y, float bottom_y) {
  Piece lamp;
  lamp.name = "pendant";
  const int metal = kit->palette->metal();
  const float r = kit->draw(0.14f, 0.26f), h = kit->draw(0.14f, 0.24f);
  kit->turned(&lamp,
              {{0, ceiling_y - 0.03f},
               {0.05f, ceiling_y - 0.02f},
               {0.055f, ceiling_y - 0.001f},
               {0, ceiling_y - 0.001f}},
              metal, {}, false, 1);
  kit->bar(&lamp, {{0, bottom_y + 0.7f * h, 0}, {0, ceiling_y - 0.02f, 0}}, 0.004f,
           kit->palette->black());
  if (kit->chance(0.5f)) {
    add_shade(kit, &lamp, {0, bottom_y, 0}, r, r * kit->draw(0.4f, 0.9f), h);
  } else if (kit->chance(0.5f)) {  // a dome
    const float t = 0.004f;
    std::vector<Vec2> outer, inner;
    for (int i = 0; i <= 8; ++i) {
      const float a = kPi / 2 * static_cast<float>(i) / 8;
      const float k = std::cos(a), s = std::sin(a);
      outer.push_back({std::max(r * k, 0.012f), h * s});
      inner.insert(inner.begin(), {std::max((r - t) * k, 0.008f), (h - t) * s});
    }
    outer.insert(outer.end(), inner.begin(), inner.end());
    kit->turned(&lamp, outer, kit->palette->lacquer(), {0, bottom_y, 0}, true);
    add_bulb(kit, &lamp, {0, bottom_y + 0.3f * h, 0}, 0.045f, kit->chance(kit->lit_share));
  } else {  // a globe
    add_bulb(kit, &lamp, {0, bottom_y + 0.13f, 0}, 0.13f, kit->chance(kit->lit_share));
    kit->turned(&lamp, {{0, 0.24f}, {0.05f, 0.24f}, {0.04f, 0.29f}, {0, 0.3f}}, metal,
                {0, bottom_y, 0}, false, 1);
  }
  return lamp;
}

Piece make_strip(Kit* kit, float length) {
  Piece strip;
  strip.name = "strip light";
  const float half = length / 2;
  kit->block(&strip, {-half, 0, 0.001f}, {half, 0.05f, 0.03f}, kit->palette->chrome(), 0.004f);
  const Mesh tube_light = tube({{-half + 0.02f, 0.025f, 0.048f}, {half - 0.02f, 0.025f, 0.048f}},
                               0.016f, kit->detail.turn(0.016f));
  const bool lit = kit->chance(kit->lit_share);
  const float area = 2 * kPi * 0.016f * length;
  strip.add(tube_light,
            lit ? kit->palette->emitter("strip", lamp_radiance(kit, area)) : kit->palette->paper());
  return strip;
}

}  // namespace lte::datagen::homes
