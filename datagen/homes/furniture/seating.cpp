// Sofas, armchairs, chairs, stools.
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {

Piece make_sofa(Kit* kit, int seats) {
  Piece sofa;
  sofa.name = seats == 1 ? "armchair" : "sofa";
  const int cloth = kit->palette->upholstery();
  const float seat_width = seats == 1 ? kit->draw(0.58f, 0.66f) : kit->draw(0.62f, 0.78f);
  const float arm = kit->draw(0.12f, 0.22f), depth = kit->draw(0.85f, 0.98f);
  const float half = seat_width * static_cast<float>(seats) / 2, z0 = -depth / 2, z1 = depth / 2;
  const float leg = kit->draw(0.07f, 0.16f), base = leg + 0.18f,
              seat = base + kit->draw(0.13f, 0.18f);
  const float back_top = kit->draw(0.78f, 0.92f), arm_top = kit->draw(0.55f, 0.65f), back = 0.2f;
  kit->legs(&sofa, {-half - arm + 0.04f, 0, z0 + 0.04f}, {half + arm - 0.04f, leg, z1 - 0.06f},
            0.05f, kit->chance(0.5f) ? Kit::Legs::Tapered : Kit::Legs::Square,
            kit->palette->wood());
  kit->soft_block(&sofa, {-half - 0.01f, leg, z0 + 0.02f}, {half + 0.01f, base, z1 - 0.01f}, cloth,
                  0.02f, 0);
  for (const float side : {-1.0f, 1.0f}) {
    const float a = side * half, b = side * (half + arm);
    kit->soft_block(&sofa, {std::min(a, b), leg, z0}, {std::max(a, b), arm_top, z1}, cloth,
                    kit->chance(0.5f) ? 0.07f : 0.035f, 0.012f);
  }
  kit->soft_block(&sofa, {-half, base, z0}, {half, back_top - 0.06f, z0 + 0.14f}, cloth, 0.05f,
                  0.01f);
  for (int i = 0; i < seats; ++i) {
    const float x0 = -half + seat_width * static_cast<float>(i) + 0.004f,
                x1 = x0 + seat_width - 0.008f;
    kit->soft_block(&sofa, {x0, base, z0 + back - 0.02f}, {x1, seat, z1 + 0.01f}, cloth, 0.045f,
                    0.02f);
    const Affine lean = translation({0, seat + 0.01f, z0 + back + 0.03f}) * rotation(0, -12);
    kit->soft_block(&sofa, {x0, 0, -0.09f}, {x1, back_top - seat, 0.07f}, cloth, 0.06f, 0.03f,
                    lean);
  }
  const int scatter = seats == 1 ? kit->count(0, 1) : kit->count(1, seats);
  for (int i = 0; i < scatter; ++i) {
    const float reach = half - 0.24f,
                t = scatter == 1 ? 0.0f : static_cast<float>(i) / static_cast<float>(scatter - 1);
    const float x = seats == 1 ? 0 : -reach + 2 * reach * t + kit->draw(-0.03f, 0.03f);
    const float size = kit->draw(0.38f, 0.46f);
    const Affine at = translation({x, seat + 0.21f, z0 + back + 0.2f}) *
                      rotation(1, kit->draw(-12, 12)) * rotation(2, kit->draw(-6, 6)) *
                      rotation(0, 68);
    kit->pillow(&sofa, {size, 0.15f, size * 0.95f}, kit->palette->accent(), at);
  }
  return sofa;
}

Piece make_chair(Kit* kit) {
  Piece chair;
  chair.name = "chair";
  const int wood = kit->palette->wood();
  const float half = 0.215f, seat = 0.45f, back = kit->draw(0.82f, 0.98f), z0 = -half;
  const bool padded = kit->chance(0.5f);
  kit->legs(&chair, {-half, 0, z0}, {half, seat - 0.03f, half}, 0.042f,
            kit->chance(0.6f) ? Kit::Legs::Tapered : Kit::Legs::Square, wood);
  kit->block(&chair, {-half, seat - 0.035f, z0}, {half, seat - (padded ? 0.015f : 0), half}, wood,
             0.012f);
  if (padded)
    kit->soft_block(&chair, {-half + 0.01f, seat - 0.015f, z0 + 0.03f},
                    {half - 0.005f, seat + 0.02f, half - 0.005f}, kit->palette->upholstery(),
                    0.016f, 0.012f);
  const float lean = 0.05f;
  for (const float x : {-half + 0.02f, half - 0.02f})
    kit->bar(&chair,
             smooth(std::vector<Vec3>{{x, seat - 0.03f, z0 + 0.02f},
                                      {x, (seat + back) / 2, z0 + 0.015f},
                                      {x, back, z0 - lean}},
                    3),
             0.016f, wood);
  const int style = kit->count(0, 2);
  const auto curve = [&](float y) {
    return z0 + 0.015f - lean * std::pow((y - seat) / (back - seat), 2.0f);
  };
  if (style == 0) {  // ladder
    for (const float t : {0.35f, 0.62f, 0.9f}) {
      const float y = seat + t * (back - seat);
      kit->block(&chair, {-half + 0.025f, y - 0.03f, curve(y) - 0.009f},
                 {half - 0.025f, y + 0.03f, curve(y) + 0.009f}, wood, 0.008f);
    }
  } else if (style == 1) {  // spindles under a rail
    const float rail = back - 0.03f;
    kit->block(&chair, {-half + 0.02f, rail - 0.03f, curve(rail) - 0.012f},
               {half - 0.02f, rail + 0.03f, curve(rail) + 0.012f}, wood, 0.01f);
    for (int i = 1; i < 6; ++i) {
      const float x = -half + 2 * half * static_cast<float>(i) / 6;
      kit->bar(&chair, {{x, seat - 0.03f, z0 + 0.02f}, {x, rail - 0.02f, curve(rail)}}, 0.007f,
               wood);
    }
  } else {  // a bent panel
    const float low = seat + 0.14f;
    const auto at = [&](float u, float v) {
      const float x = (2 * u - 1) * (half - 0.02f), y = low + v * (back - low - 0.01f);
      return Vec3{x, y, curve(y) - 0.03f * (1 - std::pow(2 * u - 1, 2.0f))};
    };
    chair.add(sheet(kit->detail.steps(0.4f, 0.04f), kit->detail.steps(0.3f, 0.06f), at, 0.016f),
              wood);
  }
  return chair;
}

Piece make_stool(Kit* kit) {
  Piece stool;
  stool.name = "stool";
  const int wood = kit->palette->wood();
  const float seat = kit->draw(0.42f, 0.48f), r = kit->draw(0.16f, 0.2f);
  kit->legs(&stool, {-0.7f * r, 0, -0.7f * r}, {0.7f * r, seat - 0.03f, 0.7f * r}, 0.035f,
            Kit::Legs::Tapered, wood);
  kit->turned(&stool,
              {{0, seat - 0.035f},
               {r - 0.01f, seat - 0.035f},
               {r, seat - 0.018f},
               {r - 0.01f, seat},
               {0, seat - 0.006f}},
              wood);
  return stool;
}

Piece make_desk_chair(Kit* kit) {
  Piece chair;
  chair.name = "desk chair";
  const int black = kit->palette->black(), cloth = kit->palette->upholstery();
  for (int i = 0; i < 5; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / 5, c = std::cos(a), s = std::sin(a);
    kit->bar(&chair, {{0, 0.1f, 0}, {0.27f * c, 0.07f, 0.27f * s}}, 0.018f, black);
    Mesh wheel = lathe({{0, -0.02f}, {0.028f, -0.018f}, {0.03f, 0}, {0.028f, 0.018f}, {0, 0.02f}},
                       kit->detail.turn(0.03f));
    chair.add(wheel, black,
              translation({0.27f * c, 0.03f, 0.27f * s}) *
                  rotation(1, 40 * static_cast<double>(i)) * rotation(0, 90));
  }
  kit->turned(&chair, {{0, 0.07f}, {0.03f, 0.07f}, {0.03f, 0.4f}, {0, 0.4f}}, kit->palette->metal(),
              {}, false, 1);
  kit->soft_block(&chair, {-0.24f, 0.4f, -0.22f}, {0.24f, 0.48f, 0.24f}, cloth, 0.035f, 0.012f);
  kit->bar(&chair,
           smooth(std::vector<Vec3>{{0, 0.41f, -0.1f}, {0, 0.42f, -0.27f}, {0, 0.6f, -0.29f}}, 4),
           0.02f, black);
  const Affine lean = translation({0, 0.56f, -0.25f}) * rotation(0, -8);
  kit->soft_block(&chair, {-0.22f, 0, -0.03f}, {0.22f, 0.46f, 0.03f}, cloth, 0.028f, 0.012f, lean);
  for (const float x : {-0.27f, 0.27f}) {
    kit->bar(&chair,
             smooth(std::vector<Vec3>{{x * 0.8f, 0.42f, 0}, {x, 0.45f, 0}, {x, 0.64f, -0.02f}}, 3),
             0.012f, black);
    kit->block(&chair, {x - 0.03f, 0.63f, -0.13f}, {x + 0.03f, 0.66f, 0.13f}, black, 0.014f);
  }
  return chair;
}

}  // namespace lte::datagen::homes
