// Beds, their mattresses and their bedding.
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

struct BedSize {
  float half, length, rail, top;  ///< half width; y of the slats and of the mattress
};

/// Cloth that lies over the mattress from z0 to z1 and hangs down at both sides.
void add_drape(Kit* kit, Piece* bed, const BedSize& size, float z0, float z1, float lift,
               float drop, float thick, int material) {
  const float half = size.half + 0.012f + lift, round = 0.05f,
              y = size.top + 0.012f + lift + thick / 2;
  const float flat = half - round, arc = kPi / 2 * round, total = flat + arc + drop;
  const float phase = kit->draw(0, 6), folds = kit->draw(7, 11), puff = std::min(0.02f, thick);
  const auto at = [&](float u, float v) {
    const float s = (2 * u - 1) * total, a = std::abs(s), side = s < 0 ? -1.0f : 1.0f;
    const float z = z0 + v * (z1 - z0);
    const float wave = 0.5f + 0.5f * std::sin(folds * z + phase + 2 * std::sin(5 * s));
    Vec3 p;
    if (a <= flat) {
      p = {s, y, z};
    } else if (a <= flat + arc) {
      const float t = (a - flat) / round;
      p = {side * (flat + round * std::sin(t)), y - round * (1 - std::cos(t)), z};
    } else {
      const float down = a - flat - arc;
      p = {side * (half + 0.25f * down * wave * 0.3f), y - round - down * (0.94f + 0.06f * wave),
           z};
    }
    const float quilt = std::sin(9 * s + phase) * std::sin(6 * z + phase) + 0.5f * wave;
    p.y += puff * (a <= flat ? std::max(0.0f, quilt) : 0.0f);
    return p;
  };
  const int across = kit->detail.steps(2 * total, 0.03f),
            along = kit->detail.steps(z1 - z0, 0.035f);
  bed->add(sheet(across, along, at, thick), material);
}

void add_headboard(Kit* kit, Piece* bed, const BedSize& size, float z, int wood) {
  const float top = kit->draw(0.85f, 1.2f), half = size.half + 0.04f;
  switch (kit->count(0, 2)) {
    case 0:
      kit->block(bed, {-half, 0.1f, z - 0.04f}, {half, top, z}, wood, 0.012f);
      break;
    case 1: {  // upholstered in upright channels
      const int channels = static_cast<int>(2 * half / 0.22f);
      const float width = 2 * half / static_cast<float>(channels);
      const int cloth = kit->palette->upholstery();
      kit->block(bed, {-half, 0.1f, z - 0.05f}, {half, top - 0.01f, z - 0.04f}, wood);
      for (int i = 0; i < channels; ++i) {
        const float x = -half + width * static_cast<float>(i);
        kit->soft_block(bed, {x, 0.25f, z - 0.04f}, {x + width, top, z + 0.03f}, cloth, 0.03f,
                        0.01f);
      }
      break;
    }
    default: {  // spindles between posts
      for (const float x : {-half, half - 0.05f})
        kit->block(bed, {x, 0, z - 0.05f}, {x + 0.05f, top, z}, wood, 0.01f);
      kit->block(bed, {-half + 0.05f, top - 0.12f, z - 0.04f},
                 {half - 0.05f, top - 0.05f, z - 0.01f}, wood, 0.012f);
      const int spindles = static_cast<int>(2 * half / 0.12f);
      for (int i = 1; i < spindles; ++i) {
        const float x = -half + 2 * half * static_cast<float>(i) / static_cast<float>(spindles);
        kit->bar(bed, {{x, size.rail, z - 0.025f}, {x, top - 0.1f, z - 0.025f}}, 0.011f, wood);
      }
    }
  }
}

}  // namespace

Piece make_bed(Kit* kit, bool two) {
  Piece bed;
  bed.name = "bed";
  BedSize size{};
  size.half = two ? kit->draw(0.7f, 0.9f) : kit->draw(0.45f, 0.5f);
  size.length = kit->draw(1.95f, 2.05f);
  size.rail = kit->draw(0.26f, 0.34f);
  size.top = size.rail + kit->draw(0.2f, 0.26f);
  const int wood = kit->palette->front(), sheets = kit->palette->bedding(),
            blanket = kit->palette->blanket();
  const float z0 = -size.length / 2, z1 = size.length / 2, w = size.half + 0.03f;

  kit->legs(&bed, {-w + 0.02f, 0, z0 + 0.02f}, {w - 0.02f, size.rail - 0.12f, z1 + 0.01f}, 0.06f,
            kit->chance(0.5f) ? Kit::Legs::Square : Kit::Legs::Tapered, wood);
  kit->block(&bed, {-w, size.rail - 0.14f, z0}, {w, size.rail, z1 + 0.03f}, wood, 0.012f);
  add_headboard(kit, &bed, size, z0 - 0.01f, wood);
  kit->soft_block(&bed, {-size.half, size.rail, z0 + 0.01f}, {size.half, size.top, z1}, sheets,
                  0.06f, 0.006f);

  const float turned_back = z0 + kit->draw(0.5f, 0.7f), thick = kit->draw(0.03f, 0.05f);
  add_drape(kit, &bed, size, turned_back, z1 - 0.01f, 0, kit->draw(0.12f, 0.22f), thick, blanket);
  add_drape(kit, &bed, size, turned_back - 0.16f, turned_back + 0.14f, thick + 0.012f, 0.12f,
            0.025f, sheets);
  if (kit->chance(0.5f))
    add_drape(kit, &bed, size, z1 - kit->draw(0.5f, 0.7f), z1 - 0.12f, thick + 0.026f, 0.24f,
              0.012f, kit->palette->accent());

  const int pillows = two ? 2 : 1;
  const float pitch = 2 * size.half / static_cast<float>(pillows);
  for (int i = 0; i < pillows; ++i) {
    const float x = -size.half + pitch * (static_cast<float>(i) + 0.5f);
    const Affine lean = translation({x, size.top + 0.17f, z0 + 0.2f}) *
                        rotation(1, kit->draw(-5, 5)) * rotation(0, kit->draw(32, 42));
    kit->pillow(&bed, {std::min(0.68f, pitch - 0.06f), 0.17f, 0.44f}, sheets, lean);
    if (kit->chance(0.6f)) {
      const Affine front =
          translation({x + kit->draw(-0.05f, 0.05f), size.top + 0.19f, z0 + 0.4f}) *
          rotation(1, kit->draw(-9, 9)) * rotation(0, kit->draw(50, 62));
      kit->pillow(&bed, {kit->draw(0.38f, 0.45f), 0.15f, 0.4f}, kit->palette->accent(), front);
    }
  }
  return bed;
}

}  // namespace lte::datagen::homes
