#include "datagen/homes/kit.h"

#include <algorithm>
#include <cmath>

namespace lte::datagen::homes {

void Kit::block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius,
                const Affine& at) {
  Mesh box = rounded_box(low, high, radius, detail.bevel());
  const Vec2 shift{rng.uniform(), rng.uniform()};
  for (Vec2& uv : box.uvs[0]) uv = {uv.x + shift.x, uv.y + shift.y};
  piece->add(box, material, at);
}

void Kit::soft_block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius,
                     float bulge_m, const Affine& at) {
  const Vec3 size = high - low, centre = (low + high) * 0.5f;
  const float cell = 0.05f / detail.level;
  Mesh box = rounded_box(low, high, radius, detail.bevel() + 1, cell);
  const float phase = draw(0, 6), wave = draw(7, 12);
  displace(&box, [&](const Vec3& p) {
    const Vec3 q = {2 * (p.x - centre.x) / size.x, 2 * (p.y - centre.y) / size.y,
                    2 * (p.z - centre.z) / size.z};
    const auto hill = [](float a, float b) {
      return std::max(0.0f, 1 - a * a) * std::max(0.0f, 1 - b * b);
    };
    const float uneven = 0.12f * std::sin(wave * p.x + phase) * std::sin(wave * p.z + 2 * phase);
    return Vec3{0, q.y, 0} * (bulge_m * (hill(q.x, q.z) + uneven)) +
           Vec3{q.x * hill(q.y, q.z), 0, q.z * hill(q.x, q.y)} * (0.4f * bulge_m);
  });
  piece->add(box, material, at);
}

void Kit::pillow(Piece* piece, const Vec3& size, int material, const Affine& at) {
  piece->add(cushion(size, 2 * detail.turn(0.3f)), material, at);
}

void Kit::turned(Piece* piece, const std::vector<Vec2>& profile, int material, const Vec3& at,
                 bool ring, int smooth_steps) {
  float widest = 0;
  for (const Vec2& p : profile) widest = std::max(widest, p.x);
  const int steps =
      std::max(1, static_cast<int>(std::lround(detail.level * static_cast<float>(smooth_steps))));
  const auto curve = smooth_steps > 1 && !ring ? smooth(profile, steps) : profile;
  piece->add(lathe(curve, detail.turn(widest), ring), material, translation(at));
}

void Kit::bar(Piece* piece, const std::vector<Vec3>& path, float radius, int material) {
  piece->add(tube(path, radius, detail.turn(radius)), material);
}

void Kit::legs(Piece* piece, const Vec3& low, const Vec3& high, float thickness, Legs kind,
               int material) {
  for (const bool right : {false, true}) {
    for (const bool front : {false, true}) {
      const float x = right ? high.x - thickness / 2 : low.x + thickness / 2;
      const float z = front ? high.z - thickness / 2 : low.z + thickness / 2;
      const float r = thickness / 2;
      if (kind == Legs::Square) {
        block(piece, {x - r, low.y, z - r}, {x + r, high.y, z + r}, material);
      } else if (kind == Legs::Tapered) {
        turned(piece, {{0, low.y}, {0.55f * r, low.y}, {r, high.y}, {0, high.y}}, material,
               {x, 0, z}, false, 1);
      } else {
        bar(piece, {{x, low.y, z}, {x, high.y, z}}, 0.6f * r, material);
      }
    }
  }
}

void Kit::fronts(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers,
                 int material, int handle) {
  constexpr float kGap = 0.003f, kThick = 0.02f;
  const float width = (high.x - low.x) / static_cast<float>(columns);
  const int rows = std::max(1, drawers);
  const float height = (high.y - low.y) / static_cast<float>(rows);
  const bool knobs = handle % 2 == 0, panelled = drawers == 0 && width > 0.25f;
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) {
      const float x0 = low.x + width * static_cast<float>(c) + kGap, x1 = x0 + width - 2 * kGap;
      const float y0 = low.y + height * static_cast<float>(r) + kGap, y1 = y0 + height - 2 * kGap;
      block(piece, {x0, y0, low.z}, {x1, y1, low.z + kThick}, material, 0.003f);
      if (panelled && handle % 3 != 0)
        block(piece, {x0 + 0.07f, y0 + 0.07f, low.z + 0.8f * kThick},
              {x1 - 0.07f, y1 - 0.07f, low.z + kThick + 0.008f}, material, 0.006f);
      // Doors open from the middle of a pair; drawers from their centre.
      const float hx =
          drawers ? (x0 + x1) / 2 : (c % 2 == 0 && columns > 1 ? x1 - 0.04f : x0 + 0.04f);
      const float hy = drawers ? (y0 + y1) / 2
                               : (low.y > 1       ? y0 + 0.12f
                                  : high.y > 1.4f ? 1.05f
                                                  : y1 - 0.12f);
      const float z = low.z + kThick;
      const int metal = palette->metal();
      if (knobs) {
        Mesh knob = lathe(smooth(std::vector<Vec2>{{0, 0},
                                                   {0.006f, 0},
                                                   {0.006f, 0.012f},
                                                   {0.014f, 0.02f},
                                                   {0.01f, 0.028f},
                                                   {0, 0.03f}},
                                 2),
                          detail.turn(0.014f));
        piece->add(knob, metal, translation({hx, hy, z}) * rotation(0, 90));
      } else {
        const float half = std::min(0.07f, 0.3f * width);
        const Vec3 way = drawers ? Vec3{half, 0, 0} : Vec3{0, half, 0};
        const Vec3 mid{hx, hy, z + 0.025f}, back{0, 0, -0.026f};
        bar(piece,
            smooth(std::vector<Vec3>{mid - way + back, mid - way, mid + way, mid + way + back}, 3),
            0.005f, metal);
      }
    }
  }
}

void Kit::cabinet(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers,
                  int body, int front, int handle) {
  constexpr float kFront = 0.02f, kPlinth = 0.06f;
  const bool stands = low.y < 0.01f;
  const float bottom = low.y + (stands ? kPlinth : 0);
  const Vec3 case_high{high.x, high.y, high.z - kFront};
  if (stands)
    block(piece, {low.x + 0.01f, low.y, low.z}, {high.x - 0.01f, bottom, high.z - kFront - 0.05f},
          body, 0.002f);
  block(piece, {low.x, bottom, low.z}, case_high, body);
  fronts(piece, {low.x + 0.004f, bottom + 0.004f, high.z - kFront},
         {high.x - 0.004f, high.y - 0.004f, high.z}, columns, drawers, front, handle);
}

void Kit::book_row(Piece* piece, float x0, float x1, float y, float clear, float z0, float z1) {
  float x = x0;
  while (true) {
    const float thick = draw(0.012f, 0.045f), high = std::min(draw(0.17f, 0.28f), clear - 0.015f);
    const float deep = std::min(draw(0.13f, 0.2f), z1 - z0);
    if (x + thick > x1) break;
    const float front = z1 - draw(0, 0.02f) * (deep < z1 - z0 - 0.02f ? 1.0f : 0.0f);
    Mesh book =
        rounded_box({x, y, front - deep}, {x + thick, y + high, front}, 0.004f, detail.bevel());
    const auto spine = static_cast<float>(rng.below(kBookSpines));
    for (size_t i = 0; i < book.positions.size(); ++i) {
      const Vec3& p = book.positions[i];
      book.uvs[0][i] = {(spine + 0.04f + 0.92f * (p.x - x) / thick) / kBookSpines,
                        1 - (p.y - y) / high};
    }
    piece->add(book, palette->books());
    x += thick + 0.0015f;
    if (chance(0.06f)) x += draw(0.03f, 0.15f);  // a gap
  }
}

}  // namespace lte::datagen::homes
